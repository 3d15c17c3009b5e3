"""Comparison with a baseline: its mean difference to the simulator is subtracted, its scatter counts as chance.

Differences of features between recordings and simulator are compared as RMS over a session. So the length of a
recording does not matter. A few recordings say little about the variance of a device from recording to recording.
Therefore the variance within both sets is shrunk towards a share of the common difference (as in G. K. Smyth, Linear
models and empirical Bayes methods, 2004).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import ndtri, stdtrit

from gyrodrift.diagnose.features.design_matrix import DesignMatrix
from gyrodrift.diagnose.features.vector import ALWAYS, FAMILIES, LINEAR, OF_EVENTS, OF_LOSS, OF_TIMES, rms_scale
from gyrodrift.diagnose.inference.evidence import NOT_COMPARED
from gyrodrift.diagnose.simulate.response_table import ResponseTable
from gyrodrift.values.arrays import Floats, Mask

PRIOR_SHARES = np.where(OF_LOSS, 1.0, np.where(OF_TIMES, 0.1, 0.7))
"""Share of the common difference by which the next recording may differ. Another motion shows another part of it.
Stamps and arrivals do not depend on motion. Losses of a radio depend on its position."""

PRIOR_RUNS = 3.0
"""Degrees of freedom that the prior counts for. Chosen: as many as the fewest recordings that make a good baseline."""

TAIL = 1e-4
"""Tail probability at which Student's quantile replaces the normal one, for a scatter from a few recordings. Chosen:
3.7 standard deviations, near the threshold of a deviation."""


@dataclass(frozen=True, slots=True)
class Baseline:
    """Difference of a device to the simulator, as RMS over a session, shape (F,) each.

    common
        Mean over the baseline recordings; 0 of features that are not compared.
    squares
        Sum over the baseline recordings of their squared differences to this mean.
    prior
        Prior variance from one recording to the next.
    compared
        Features that both sets of recordings determine.
    count
        Recordings of the baseline.
    """

    common: Floats
    squares: Floats
    prior: Floats
    compared: Mask
    count: int

    def scatter(self, differences: Floats) -> Floats:
        """(F,) standard deviation by chance of the difference of a recording to the baseline.

        It contains the error of the mean of the baseline, which is the same in all recordings.

        differences
            (sessions, F) differences of recordings that are compared with the baseline, as RMS. Their variance is
            chance too, except for coefficients and rare events: a scale error of constant size changes the
            coefficients differently in each motion, and a slip is not in each recording.
        """
        variance, _ = self._variance(differences, ~(LINEAR | OF_EVENTS))
        return np.where(self.compared, np.sqrt(variance), NOT_COMPARED)

    def extra_sigma(self, differences: Floats) -> Floats:
        """(F,) standard deviation that is added to `scatter` before a single feature counts as deviating.

        A scatter from a few recordings is uncertain. From a single feature nobody sees whether a single effect acts in
        different motions. So the variance between the later recordings counts as chance in all features.
        """
        variance, degrees = self._variance(differences, np.ones(len(LINEAR), bool))
        wide = np.square(_coverage(degrees)) * variance
        extra: Floats = np.sqrt(np.maximum(wide - np.square(self.scatter(differences)), 0.0))
        return extra

    def _variance(self, differences: Floats, is_chance: Mask) -> tuple[Floats, Floats]:
        """(F,) variance from recording to recording and its degrees of freedom.

        The scatter of `differences` is included in features with `is_chance`.
        """
        count = len(differences)
        own = np.where(is_chance, np.square(differences - differences.mean(axis=0)).sum(axis=0), 0.0)
        degrees = np.where(is_chance, self.count + count - 2.0, self.count - 1.0) + PRIOR_RUNS
        variance = (self.squares + own + PRIOR_RUNS * self.prior) / degrees * (1.0 + count / self.count)
        return variance, degrees


def baseline_of(tables: Sequence[ResponseTable], designs: Sequence[DesignMatrix], compared: Mask) -> Baseline:
    """Baseline of some recordings; `compared`, (F,), are the features that both sets of recordings determine."""
    differences = differences_of(tables, designs)
    center = np.concatenate([table.nulls / rms_scale(design) for table, design in zip(tables, designs, strict=True)])
    common = differences.mean(axis=0) - center.mean(axis=0)
    shown = np.square(common)
    squares = np.square(differences - differences.mean(axis=0)).sum(axis=0)
    varies = np.where(LINEAR, 0.0, squares / max(1, len(tables) - 1))
    is_compared = compared & (ALWAYS | np.any(center != 0.0, axis=0) | np.any(differences != 0.0, axis=0))
    return Baseline(
        common=np.where(is_compared, common, 0.0),
        squares=squares,
        prior=np.square(PRIOR_SHARES) * (shown + _of_family(shown)) + _of_family(varies),
        compared=is_compared,
        count=len(tables),
    )


def _of_family(squares: Floats) -> Floats:
    """(F,) mean over the family of a feature; 0 without a family.

    Another motion distributes the same error differently among regressors. It distributes the same shaking differently
    among the lengths over which noise in motion is averaged.
    """
    means = np.zeros_like(squares)
    for family in FAMILIES:
        means[family] = squares[family].mean()
    return means


def differences_of(tables: Sequence[ResponseTable], designs: Sequence[DesignMatrix]) -> Floats:
    """(sessions, F) differences of recordings and simulator, as RMS over each session."""
    return np.array([table.difference / rms_scale(design) for table, design in zip(tables, designs, strict=True)])


def _coverage(degrees: Floats) -> Floats:
    """Ratio of Student's quantile with these degrees of freedom to the normal one."""
    ratio: Floats = stdtrit(degrees, TAIL) / ndtri(TAIL)
    return ratio


def against(
    tables: Sequence[ResponseTable], designs: Sequence[DesignMatrix], baseline: Baseline
) -> list[ResponseTable]:
    """The tables of recordings, with the common difference of the baseline subtracted.

    The responses are those of the device. The scatter is added to the relevance thresholds.
    """
    differences = differences_of(tables, designs)
    scatter, extra_sigma = baseline.scatter(differences), baseline.extra_sigma(differences)
    moved = [
        replace(
            table,
            offset=baseline.common * rms_scale(design),
            difference=table.difference - baseline.common * rms_scale(design),
            thresholds=np.hypot(table.thresholds, scatter * rms_scale(design)),
            extra_sigma=extra_sigma * rms_scale(design),
            device_sigma=scatter * rms_scale(design),
            degrees=baseline.count - 1.0 + PRIOR_RUNS,
        )
        for table, design in zip(tables, designs, strict=True)
    ]
    return [
        replace(table, responses={name: table.in_device(change) for name, change in table.responses.items()})
        for table in moved
    ]


def against_one(table: ResponseTable, design: DesignMatrix, baseline: Baseline) -> ResponseTable:
    """The table of one recording, with the common difference of the baseline subtracted."""
    (compared,) = against([table], [design], baseline)
    return compared
