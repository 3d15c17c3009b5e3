"""Recordings of a worked-out motion, for tests of features: what the gyro says of it is up to the test."""

from functools import cache
from typing import NamedTuple

import numpy as np

from gyrodrift.diagnose.features.design_matrix import DesignMatrix, design_matrix_of
from gyrodrift.diagnose.features.vector import NUMBER, Facts, measure
from gyrodrift.diagnose.recording.gyro_noise import GyroModel
from gyrodrift.diagnose.recording.motion import ReplayedMotion
from gyrodrift.diagnose.recording.motion_posterior import motion_posterior_of
from gyrodrift.diagnose.recording.outliers import Cleaned, clean
from gyrodrift.diagnose.recording.recording import Recording, recording_of
from gyrodrift.session.session import Session
from gyrodrift.values.arrays import Floats

PERIOD_S = 0.01
SECONDS = 200
T_S: Floats = np.arange(SECONDS * 100, dtype=np.float64) * PERIOD_S
COUNTS_PER_TURN = 360_000
"""Fine enough to be taken for the truth."""

FACTS = Facts(dps_per_lsb=1e-3, encoder_cpr=COUNTS_PER_TURN, step_dps=1e-3)

KNOTS_S = (0.0, 50.0, 51.0, 80.0, 82.0, 110.0, 112.0, 140.0, 143.0, 170.0, 171.0, 200.0)
KNOTS_DPS = (0.0, 0.0, 20.0, 20.0, 90.0, 90.0, -15.0, -15.0, -80.0, -80.0, 0.0, 0.0)
TRUE_DPS: Floats = np.interp(T_S, KNOTS_S, KNOTS_DPS)
"""Rest, slow and fast turns both ways, rest; straight ramps between."""

TRUE_DEG: Floats = np.concatenate([[0.0], np.cumsum(0.5 * (TRUE_DPS[1:] + TRUE_DPS[:-1]) * PERIOD_S)])
AT_REST = (T_S < 48.0) | (T_S > 173.0)
TURNING = (T_S > 53.0) & (T_S < 168.0)


class Observed(NamedTuple):
    """A recording, cleaned, with its design matrix."""

    cleaned: Cleaned
    design: DesignMatrix

    def values(self) -> dict[str, float]:
        """All features by name."""
        result = measure(self.cleaned, self.design, FACTS).values
        return {name: float(result[number]) for name, number in NUMBER.items()}


def white(sigma: float, seed: int = 1, count: int = len(T_S)) -> Floats:
    """Normal numbers."""
    return np.random.default_rng(seed).normal(0.0, sigma, count)


def recorded(rate_dps: Floats, angle_deg: Floats = TRUE_DEG, cpr: int = COUNTS_PER_TURN) -> Recording:
    counts_deg = np.round(angle_deg * cpr / 360.0) * 360.0 / cpr
    t_s = T_S[: len(rate_dps)]
    return recording_of(Session("turns", t_s, rate_dps, 1.7e9 + t_s, np.arange(len(t_s)), counts_deg))


@cache
def true_design() -> DesignMatrix:
    motion = ReplayedMotion(PERIOD_S, TRUE_DEG, TRUE_DPS, np.full(len(T_S), 25.0), 0.0)
    return design_matrix_of(clean(recorded(TRUE_DPS)), motion)


def design_of(cleaned: Cleaned) -> DesignMatrix:
    return design_matrix_of(cleaned, motion_posterior_of(cleaned, GyroModel(FACTS.dps_per_lsb)).mean)


def observed(rate_dps: Floats) -> Observed:
    """A rate beside the worked-out motion."""
    return Observed(clean(recorded(rate_dps)), true_design())


def observed_beside(rate_dps: Floats, angle_deg: Floats, cpr: int = COUNTS_PER_TURN) -> Observed:
    """A rate beside another angle."""
    events = clean(recorded(rate_dps, angle_deg, cpr))
    return Observed(events, design_of(events))
