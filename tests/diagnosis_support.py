"""Diagnoses made by hand, for tests of what is drawn and written of them: nothing is simulated or loaded."""

from types import SimpleNamespace
from typing import cast

import numpy as np
from inference_support import Amounts, concluded, rows, simulated

from firmware_sim.rig import load_rig
from gyrodrift.diagnose.features.design_matrix import COLUMNS, DesignMatrix
from gyrodrift.diagnose.features.vector import FEATURES
from gyrodrift.diagnose.features.within_second import LAG_FEATURES
from gyrodrift.diagnose.inference.detectable import detectable
from gyrodrift.diagnose.predictive_checks.feature_comparison import feature_comparisons_of
from gyrodrift.diagnose.predictive_checks.rate_errors import (
    Compared,
    Dependence,
    RateErrors,
    ResidualSeries,
    Spectra,
    trend_of,
)
from gyrodrift.diagnose.predictive_checks.yaw_impact import YawImpact
from gyrodrift.diagnose.result import BaseValue, DiagnosedSession, Diagnosis, Untestable
from gyrodrift.simulation.sessions import rig_yaml
from gyrodrift.values.arrays import Floats

SESSIONS, SECONDS = 2, 180
SCALED: Amounts = {"rate": 10.0, "rate_cubed": 6.5}
"""Sessions of a gyro that reads too much, and of which something is left unexplained."""

TRIED = (
    simulated("scale_factor", {"rate": 2.0}, sessions=SESSIONS),
    simulated("scale_asymmetry", {"rate": 1.0, "abs_rate": 0.5}, sessions=SESSIONS),
    simulated("latency", {"lag": 2.0}, sessions=SESSIONS),
)


def diagnosis(away: Amounts) -> Diagnosis:
    verdict, explanation = concluded(rows(away, SESSIONS), *TRIED)
    rig = load_rig(None)
    effects = tuple(cause.effect for cause in verdict.causes)
    none = np.zeros((SESSIONS, len(FEATURES)))
    return Diagnosis(
        verdict=verdict,
        yaw_impact=YawImpact(12.5, 0.5, 12.1, 160.0, 155.0, 150.0),
        contradictions=(),
        remarks=(),
        untestable=(Untestable("clock_drift", "no host times"), Untestable("temp_bias", "no temperature")),
        withheld=("popcorn",),
        detectable=detectable(explanation.scorer, explanation.evidence.effects()),
        calibration=(
            BaseValue("bias_dps", 0.5, 0.35, 0.34, 0.36),
            BaseValue("sample_rate_hz", 100.0, 99.0, 98.0, 100.0),
        ),
        next_step="Record more sessions: with three and more the fit can be checked.",
        next_profile_yaml=None,
        seconds=12.5,
        sessions=tuple(_session(number) for number in range(1, SESSIONS + 1)),
        rig_yaml=rig_yaml(rig.model_copy(update={"effects": (*rig.effects, *effects)})),
        posterior=explanation.posterior.probable_sets(),
        threshold_z=explanation.evidence.threshold_z,
        features=feature_comparisons_of(explanation, none, [design()] * SESSIONS),
        rate_errors=_rate_errors(),
    )


def design() -> DesignMatrix:
    item = SimpleNamespace(
        static=SimpleNamespace(vectors=np.zeros((SECONDS, len(COLUMNS)))),
        lag=SimpleNamespace(vectors=np.zeros((100 * SECONDS, len(LAG_FEATURES)))),
    )
    return cast("DesignMatrix", item)


def _session(number: int) -> DiagnosedSession:
    return DiagnosedSession(
        name=f"session-0{number}",
        minutes=3.0,
        sample_rate_hz=100.0,
        bias_dps=0.35,
        noise_dps_rthz=0.0035,
        has_host_times=number == 1,
        has_temperature=number == 1,
        has_counter=number == 1,
    )


def _rate_errors() -> RateErrors:
    rng = np.random.default_rng(1)
    rate_dps = np.repeat(rng.uniform(-90.0, 90.0, SECONDS // 10), 10)
    noise_dps = rng.normal(0.0, 0.01, (SESSIONS, 4, SECONDS))
    hz = np.geomspace(0.4, 50.0, 30)
    spectra = Spectra(hz, np.full(30, 3.0), np.full(30, 2.0), np.full(30, 1.0))
    minutes = np.arange(0.5, SECONDS, dtype=np.float64) / 60.0
    sessions = tuple(
        ResidualSeries(
            number=number + 1,
            name=f"session-0{number + 1}",
            minutes=minutes,
            errors=Compared(0.05 * rate_dps + own[0], own[1], 0.05 * rate_dps + own[2], own[3]),
            windows=np.zeros((3, 0, 256)),
            period_s=0.01,
        )
        for number, own in enumerate(noise_dps)
    )
    x = np.tile(rate_dps, SESSIONS)
    names = ("rate", "temperature", "angle within the turn")
    return RateErrors(sessions, tuple(_dependence(name, x, sessions) for name in names), spectra)


def _dependence(name: str, x: Floats, sessions: tuple[ResidualSeries, ...]) -> Dependence:
    order = np.argsort(x)
    columns = zip(*(session.errors for session in sessions), strict=True)
    errors = Compared(*(np.concatenate(column)[order] for column in columns))
    real, before, after, unexplained = (trend_of(x[order], column) for column in errors)
    without = trend_of(x[order], errors.real - errors.before).rms
    return Dependence(name, "deg/s", x[order], errors, (real, before, after, unexplained), without)
