"""A tuning as values, for tests of what is made of one."""

from dataclasses import replace

import numpy as np

from gyrodrift.evaluation.dataset import SessionSummary, Split, YawCurves
from gyrodrift.evaluation.score import Score
from gyrodrift.evaluation.space import axes_of
from gyrodrift.filters.filter import Filter
from gyrodrift.filters.hdr import HdrParams
from gyrodrift.filters.hdr_filter import HDR
from gyrodrift.filters.restlevel_filter import RESTLEVEL
from gyrodrift.tune.result import Alternative, Pi, Run, SessionScore, Tuning
from gyrodrift.tune.warnings import SCAN_POINTS

AXES = axes_of(HDR)
PARAMS = HdrParams(0.000457, 0.0384, 0.123, 1.85, 0.0)
MINUTES = 20.0


def run(seed: int = 1, evaluations: int = 90, pi: Pi = Pi(0.1775, 0.2838)) -> Run:  # noqa: B008 - frozen
    rng = np.random.default_rng(seed)
    costs = np.exp(rng.normal(4.0, 3.0, evaluations)) * np.linspace(1.0, 0.05, evaluations)
    densities = 1.0 + np.sin(np.linspace(0.0, 6.0, 501)) * np.linspace(0.2, 0.8, 5)[:, np.newaxis]
    return Run(seed, costs, rng.random((evaluations, 5)), PARAMS, pi, densities)


def of_e(e_deg: float) -> Score:
    """A session that is always off by so much."""
    return Score(e_deg, e_deg / MINUTES, e_deg * e_deg, e_deg)


def score(name: str, split: Split = Split.TRAIN, e_tuned_deg: float = 0.5) -> SessionScore:
    session = SessionSummary(name, "", MINUTES, 100.0)
    return SessionScore(session, split, of_e(56.4), of_e(e_tuned_deg), of_e(0.75), curve())


def curve(points: int = 400) -> YawCurves:
    """Errors of 112 deg by plain integration and of 0.5 deg at most by the tuned filter, after 20 minutes."""
    minutes = np.linspace(0.0, MINUTES, points)
    reference_deg = 90.0 * np.floor(minutes)
    errors_deg = np.array([5.6 * minutes, 0.5 * np.sin(3.0 * minutes)])
    return YawCurves(minutes, reference_deg, reference_deg + errors_deg)


def curve_of(euler_deg: float, tuned_deg: float) -> YawCurves:
    """A curve with these errors all along, beside a reference of 0."""
    minutes = np.linspace(0.0, MINUTES, 400)
    return YawCurves(minutes, np.zeros(400), np.repeat([[euler_deg], [tuned_deg]], 400, axis=1))


def tuning(train: int = 2, test: int = 2) -> Tuning:
    names = [(f"walk-{n}", Split.TRAIN) for n in range(train)] + [(f"check-{n}", Split.TEST) for n in range(test)]
    return Tuning(
        filter=HDR,
        method="race",
        evaluations=90,
        axes=AXES,
        run=run(pi=Pi(0.1775, 0.2838 if test else None)),
        euler=Pi(6877.0, 2008.0 if test else None),
        reduced=Pi(0.1754, 0.3236 if test else None),
        reduced_params=HdrParams(0.001, 0.0, 0.25, 0.0, 0.0),
        scores=tuple(score(*name) for name in names),
        sample_rate_hz=100.0,
        seconds=8.7,
    )


def alternative(key: str, title: str, train_deg: float, test_deg: float, kind: Filter | None = None) -> Alternative:
    """A filter, tuned if its title says so, that is always off by these angles."""
    pi, is_tuned = Pi(train_deg**2, test_deg**2), title.endswith("tuned")
    return Alternative(key, title, pi, Pi(train_deg, test_deg), kind, PARAMS if kind else None, is_tuned)


def tuning_of_both() -> Tuning:
    """HDR in the config, though the defaults of restlevel are better, and slices of equal rise."""
    alternatives = (
        alternative("euler", "plain integration", 56.0, 57.0),
        alternative("start", "start calibration", 0.9, 1.0),
        alternative("hdr", "HDR, defaults", 55.0, 56.0, HDR),
        alternative("hdr", "HDR, tuned", 0.5, 0.7, HDR),
        alternative("restlevel", "restlevel, defaults", 0.1, 0.2, RESTLEVEL),
    )
    slices = np.tile(np.geomspace(0.1, 10.0, SCAN_POINTS), (len(AXES), 1))
    return replace(tuning(), alternatives=alternatives, slices=slices, slice_axes=AXES)
