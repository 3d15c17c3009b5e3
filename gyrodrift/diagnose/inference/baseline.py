"""Comparison with a baseline: its mean difference to the simulator is subtracted, its scatter counts as chance.

Differences of features between recordings and simulator are compared as RMS over a session. So the length of a
recording does not matter. A few recordings say little about the variance of a device from recording to recording.
Therefore the variance within both sets is shrunk towards a share of the common difference (as in G. K. Smyth, Linear
models and empirical Bayes methods, 2004).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import ndtri, stdtr, stdtrit

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


CHANCE = 0.05
"""Probability by chance above which two sets of amounts count as equal. Chosen: the rate of false alarms of a
diagnosis. With three recordings against two without the effect, 0.01 would require amounts that agree within a
quarter."""

NOISE_DEGREES = 2.0
"""Degrees of freedom of the variance of an amount by noise. It is pooled with the variance between recordings (Smyth,
Linear models and empirical Bayes methods, 2004)."""

TINY = 1e-12
"""Least square of a change, in units of sigma: without a change there is no amount. Chosen: far below the square of a
change that shows."""


SHOWS = 2.0
"""Least norm of a change in standard deviations. A smaller change does not show. Chosen: as `NOTICEABLE` of
templates."""


def amounts_of(differences: Floats, changes: Floats, sigma: Floats) -> Floats:
    """Amount of a change in each recording, by weighted least squares.

    Recordings in which the change does not show are left out, unless it shows in none. An example is a limit of the
    gyro that a recording never reaches.

    differences, changes
        (sessions, F) features of recordings minus those of the rig, and their change by a cause.
    sigma
        (F,) standard deviation of each feature.
    """
    shows = np.linalg.norm(changes / sigma, axis=1) > SHOWS
    if shows.any():
        differences, changes = differences[shows], changes[shows]
    weighted = changes / np.square(sigma)
    amounts: Floats = (weighted * differences).sum(axis=1) / np.maximum((weighted * changes).sum(axis=1), TINY)
    return amounts


def amplitudes_of(differences: Floats, quadratures: tuple[Floats, Floats], sigma: Floats) -> Floats:
    """(sessions,) amplitude of an effect with a free phase in each recording, at least 0.

    quadratures
        (sessions, F) changes of the features by a cause at phases of 0 and 90 degrees.
    """
    columns, unexplained = np.stack(quadratures, axis=-1) / sigma[:, None], differences / sigma
    parts = [np.linalg.lstsq(own, values)[0] for own, values in zip(columns, unexplained, strict=True)]
    amplitudes: Floats = np.hypot(*np.transpose(parts))
    return amplitudes


def noise_variance_of(changes: Floats, sigma: Floats) -> float:
    """Variance of an amount by independent noise of the features."""
    return float(1.0 / max(np.square(changes / sigma).sum(axis=1).mean(), TINY))


def chance_of(today: Floats, before: Floats, noise_variance: float, *, is_random: bool = False) -> float:
    """Probability that the means of two sets of amounts of a device differ this much by chance; Student's test.

    The larger of two probabilities counts: with the variance between recordings alone, and with that of noise included.

    is_random
        Whether the effect is random. Then its amounts scatter wherever it acts, and only those of the earlier set show
        how much the device varies.
    """
    sets = (before,) if is_random else (today, before)
    squares = sum(float(np.square(amounts - amounts.mean()).sum()) for amounts in sets)
    apart = abs(float(today.mean() - before.mean())) / np.sqrt(1.0 / len(today) + 1.0 / len(before))
    degrees = float(sum(len(amounts) - 1 for amounts in sets))
    with_noise = degrees + NOISE_DEGREES, squares + NOISE_DEGREES * noise_variance
    estimates = [(degrees, squares), with_noise] if degrees > 0.0 else [with_noise]
    return max(
        float(2.0 * stdtr(freedom, -apart / np.sqrt(max(total, TINY) / freedom))) for freedom, total in estimates
    )
