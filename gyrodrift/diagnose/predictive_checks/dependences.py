"""The rate errors of sessions against all that they may depend on: clouds, binned medians, and how much follows."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gyrodrift.arrays import Floats, Integers
from gyrodrift.diagnose.predictive_checks.binned_medians import Medians, medians, shape_dps
from gyrodrift.diagnose.predictive_checks.regressors import REGRESSORS, ResidualRegressor
from gyrodrift.diagnose.predictive_checks.residual_series import ResidualSeries
from gyrodrift.diagnose.simulate.twin import Subject

LEAST_SECONDS = 20


@dataclass(frozen=True, slots=True, eq=False)
class Dependence:
    """Rate errors against one regressor, in the seconds of all drawn sessions in which it is known, in order of x.

    slack
        What the comparison itself may leave, deg/s for each unit: motion is not known to the microsecond.
    x, real_dps, left_dps
        (seconds,) the regressor, the recordings' rate errors, and what the certain causes leave unexplained of them.
    real, before, after, left
        Binned medians of these, and of the simulator without the causes and with them.
    follows_before_dps, follows_dps
        RMS of the part of what is unexplained that follows the regressor, without and with the causes.
    """

    name: str
    unit: str
    slack: float
    x: Floats
    real_dps: Floats
    left_dps: Floats
    real: Medians
    before: Medians
    after: Medians
    left: Medians
    follows_before_dps: float
    follows_dps: float


def dependences_of(sessions: Sequence[ResidualSeries], subjects: Sequence[Subject]) -> tuple[Dependence, ...]:
    """On every regressor that takes more than one value in these sessions, whose subjects are given as well."""
    found = []
    for regressor in REGRESSORS:
        x = np.concatenate([regressor.of(subject) for subject in subjects])
        order = np.argsort(x, kind="stable")[: int(np.count_nonzero(np.isfinite(x)))]  # NaN come last
        if len(order) >= LEAST_SECONDS and x[order[-1]] > x[order[0]]:
            found.append(_dependence(regressor, x[order], [_in_order(one, order) for one in _columns(sessions)]))
    return tuple(found)


def _columns(sessions: Sequence[ResidualSeries]) -> list[list[Floats]]:
    """Of all sessions: real, before, after, left."""
    rows = [(one.real_dps, one.before_dps, one.after_dps, one.left_dps) for one in sessions]
    return [list(column) for column in zip(*rows, strict=True)]


def _in_order(parts: list[Floats], order: Integers) -> Floats:
    pooled: Floats = np.concatenate(parts)[order]
    return pooled


def _dependence(regressor: ResidualRegressor, x: Floats, columns: Sequence[Floats]) -> Dependence:
    real_dps, before_dps, after_dps, left_dps = columns
    return Dependence(
        name=regressor.name,
        unit=regressor.unit,
        slack=regressor.slack,
        x=x,
        real_dps=real_dps,
        left_dps=left_dps,
        real=medians(x, real_dps),
        before=medians(x, before_dps),
        after=medians(x, after_dps),
        left=medians(x, left_dps),
        follows_before_dps=shape_dps(x, real_dps - before_dps),
        follows_dps=shape_dps(x, left_dps),
    )
