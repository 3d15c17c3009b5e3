"""What is common to a baseline and to what is diagnosed is no gap: its mean is taken away, and its scatter is chance.

Differences of features between recordings and simulator are compared as RMS over a session, so that longer recordings
do not differ by their length. How much a device differs from the simulator by itself, from one of its recordings to the
next, is known from a few recordings only: the variance within both sets is shrunk towards a share of the common
difference (as in G. K. Smyth, Linear models and empirical Bayes methods, 2004).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import norm as normal
from scipy.stats import t as student

from gyrodrift.arrays import Floats, Mask
from gyrodrift.diagnose.features.design_matrix import DesignMatrix
from gyrodrift.diagnose.features.vector import ALWAYS, LINEAR, NOISE_IN_MOTION, OF_LOSS, OF_TIMES, REGRESSORS, rms_scale
from gyrodrift.diagnose.inference.evidence import NOT_COMPARED
from gyrodrift.diagnose.simulate.response_table import ResponseTable

PRIOR_SHARES = np.where(OF_LOSS, 1.0, np.where(OF_TIMES, 0.1, 0.7))
"""Of the common difference, that the next recording may differ by: another motion shows another part of it, but for
stamps and arrivals, which know nothing of motions. What a radio loses goes by where it stands."""

PRIOR_RUNS = 3.0
"""So many degrees of freedom is the prior worth."""

TAIL = 1e-4
"""Probability at which a scatter known from a few recordings is widened to what Student's quantile says."""


@dataclass(frozen=True, slots=True)
class Baseline:
    """What a device differs from the simulator by, as RMS over a session, shape (F,) each.

    common
        Mean over the baseline recordings; 0 of features that are not compared.
    squares
        Of what single ones differ from it by, summed.
    prior
        Variance from one recording to the next that is expected beforehand.
    compared
        Features that both sets of recordings can speak of.
    count
        Recordings of the baseline.
    """

    common: Floats
    squares: Floats
    prior: Floats
    compared: Mask
    count: int

    def scatter(self, differences: Floats) -> Floats:
        """(F,) standard deviation, in each of some recordings of the device, of what is left of it.

        Their mean is compared with that of the baseline; what this one is off by is the same in all of them.

        differences
            (sessions, F) of the recordings that are compared with the baseline, as RMS. How they differ from one
            another is chance too, but for coefficients: a scale error of one size differs as much as motions do.
        """
        variance, _ = self._variance(differences, ~LINEAR)
        return np.where(self.compared, np.sqrt(variance), NOT_COMPARED)

    def doubt(self, differences: Floats) -> Floats:
        """(F,) standard deviation beyond `scatter` by which a feature has to be off to stand out by itself.

        How wide a scatter is that few recordings tell is not known well; and where nothing says that it is one effect
        in many motions, how the later recordings differ from one another is chance in all features.
        """
        variance, degrees = self._variance(differences, np.ones(len(LINEAR), bool))
        wide = np.square(_coverage(degrees)) * variance
        found: Floats = np.sqrt(np.maximum(wide - np.square(self.scatter(differences)), 0.0))
        return found

    def _variance(self, differences: Floats, is_chance: Mask) -> tuple[Floats, Floats]:
        """(F,) variance with what `differences` scatter by where that is chance, and its degrees of freedom."""
        count = len(differences)
        own = np.where(is_chance, np.square(differences - differences.mean(axis=0)).sum(axis=0), 0.0)
        degrees = np.where(is_chance, self.count + count - 2.0, self.count - 1.0) + PRIOR_RUNS
        variance = (self.squares + own + PRIOR_RUNS * self.prior) / degrees * (1.0 + count / self.count)
        return variance, degrees


def baseline_of(tables: Sequence[ResponseTable], designs: Sequence[DesignMatrix], compared: Mask) -> Baseline:
    """Of the recordings of a baseline; `compared`, (F,), are features that both sets of recordings can speak of."""
    differences = differences_of(tables, designs)
    centre = np.concatenate([table.nulls / rms_scale(design) for table, design in zip(tables, designs, strict=True)])
    common = differences.mean(axis=0) - centre.mean(axis=0)
    shown = np.square(common)
    squares = np.square(differences - differences.mean(axis=0)).sum(axis=0)
    varies = np.where(LINEAR, 0.0, squares / max(1, len(tables) - 1))
    says = compared & (ALWAYS | np.any(centre != 0.0, axis=0) | np.any(differences != 0.0, axis=0))
    return Baseline(
        common=np.where(says, common, 0.0),
        squares=squares,
        prior=np.square(PRIOR_SHARES) * (shown + _of_family(shown)) + _of_family(varies),
        compared=says,
        count=len(tables),
    )


def _of_family(squares: Floats) -> Floats:
    """(F,) mean over the family that a feature is of; 0 where it has none.

    Another motion shares the same error out differently among regressors, and the same shaking among the lengths over
    which noise in motion is averaged.
    """
    means = np.zeros_like(squares)
    for family in (REGRESSORS, *NOISE_IN_MOTION):
        means[family] = squares[family].mean()
    return means


def differences_of(tables: Sequence[ResponseTable], designs: Sequence[DesignMatrix]) -> Floats:
    """(sessions, F) differences of recordings and simulator, as RMS over each session."""
    return np.array([table.difference / rms_scale(design) for table, design in zip(tables, designs, strict=True)])


def _coverage(degrees: Floats) -> Floats:
    """How much further than a normal number one goes whose variance is known with so few degrees of freedom."""
    found: Floats = student.isf(TAIL, degrees) / normal.isf(TAIL)
    return found


def against(
    tables: Sequence[ResponseTable], designs: Sequence[DesignMatrix], baseline: Baseline
) -> list[ResponseTable]:
    """The tables of recordings, with what is common to the baseline taken from their differences.

    The scatter joins the relevance thresholds: below it nothing is told.
    """
    differences = differences_of(tables, designs)
    scatter, doubt = baseline.scatter(differences), baseline.doubt(differences)
    return [
        replace(
            table,
            difference=table.difference - baseline.common * rms_scale(design),
            thresholds=np.hypot(table.thresholds, scatter * rms_scale(design)),
            doubt=doubt * rms_scale(design),
        )
        for table, design in zip(tables, designs, strict=True)
    ]
