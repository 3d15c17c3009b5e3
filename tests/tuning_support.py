"""A tuning as values, for tests of what is made of one."""

import numpy as np

from gyrodrift.evaluation.dataset import Split
from gyrodrift.evaluation.space import AXES
from gyrodrift.evaluation.tunables import HDR_TUNABLE
from gyrodrift.filters.hdr import HdrParams
from gyrodrift.tune.result import Curve, Pi, Run, SessionScore, Tuning

PARAMS = HdrParams(0.000457, 0.0384, 0.123, 1.85, 0.0)


def run(seed: int = 1, evaluations: int = 90, pi: Pi = Pi(0.1775, 0.2838)) -> Run:  # noqa: B008 - frozen
    rng = np.random.default_rng(seed)
    costs = np.exp(rng.normal(4.0, 3.0, evaluations)) * np.linspace(1.0, 0.05, evaluations)
    densities = 1.0 + np.sin(np.linspace(0.0, 6.0, 501)) * np.linspace(0.2, 0.8, 5)[:, np.newaxis]
    return Run(seed, costs, rng.random((evaluations, 5)), PARAMS, pi, densities)


def score(name: str, split: Split = Split.TRAIN, e_tuned_deg: float = 0.5) -> SessionScore:
    return SessionScore(name, split, 20.0, 56.4, e_tuned_deg, 0.75)


def curve(name: str, split: Split = Split.TRAIN, points: int = 400) -> Curve:
    minutes = np.linspace(0.0, 20.0, points)
    return Curve(name, split, minutes, 5.6 * minutes, 0.5 * np.sin(3.0 * minutes))


def tuning(train: int = 2, test: int = 2) -> Tuning:
    names = [(f"walk-{n}", Split.TRAIN) for n in range(train)] + [(f"check-{n}", Split.TEST) for n in range(test)]
    return Tuning(
        tunable=HDR_TUNABLE,
        method="race",
        evaluations=90,
        axes=AXES,
        run=run(pi=Pi(0.1775, 0.2838 if test else None)),
        euler=Pi(6877.0, 2008.0 if test else None),
        few=Pi(0.1754, 0.3236 if test else None),
        few_params=HdrParams(0.001, 0.0, 0.25, 0.0, 0.0),
        scores=tuple(score(*name) for name in names),
        sample_rate_hz=100.0,
        seconds=8.7,
        curves=tuple(curve(*name) for name in names),
    )
