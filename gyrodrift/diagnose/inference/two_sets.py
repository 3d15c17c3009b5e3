"""Test whether a cause is new since a baseline: its amount in each recording, and Student's test between two sets.

A device varies from recording to recording mostly in its effects: gain, bias, delay. The scatter of single features
does not show that they vary together. The amount of one effect in each recording does, for any motion. Two sets of
amounts are compared (Student, The probable error of a mean, 1908).
"""

import numpy as np
from scipy.stats import t as student

from gyrodrift.arrays import Floats

CHANCE = 0.05
"""Probability by chance above which two sets of amounts count as equal: the rate of false alarms of a diagnosis. With
three recordings against two without the effect, 0.01 would require amounts that agree within a quarter."""

NOISE_DEGREES = 2.0
"""Degrees of freedom for which the variance of an amount by noise counts, beside the variance between recordings
(Smyth, Linear models and empirical Bayes methods, 2004)."""

TINY = 1e-12
"""Least square of a change, in units of sigma: without a change there is no amount."""


def amounts_of(differences: Floats, changes: Floats, sigma: Floats) -> Floats:
    """(sessions,) amount of a change in each recording, by weighted least squares.

    differences, changes
        (sessions, F) features of recordings minus those of the rig, and their change by a cause.
    sigma
        (F,) standard deviation of each feature.
    """
    weighted = changes / np.square(sigma)
    amounts: Floats = (weighted * differences).sum(axis=1) / np.maximum((weighted * changes).sum(axis=1), TINY)
    return amounts


def amplitudes_of(differences: Floats, quadratures: tuple[Floats, Floats], sigma: Floats) -> Floats:
    """(sessions,) amplitude of an effect with a free phase in each recording, at least 0.

    quadratures
        (sessions, F) each: changes of the features by a cause at phases of 0 and 90 degrees.
    """
    columns, unexplained = np.stack(quadratures, axis=-1) / sigma[:, None], differences / sigma
    parts = [np.linalg.lstsq(own, values)[0] for own, values in zip(columns, unexplained, strict=True)]
    amplitudes: Floats = np.hypot(*np.transpose(parts))
    return amplitudes


def noise_variance_of(changes: Floats, sigma: Floats) -> float:
    """Variance of an amount by independent noise of the features."""
    return float(1.0 / max(np.square(changes / sigma).sum(axis=1).mean(), TINY))


def chance_of(today: Floats, before: Floats, noise_variance: float) -> float:
    """Probability that two sets of amounts of one device differ by this much, by their scatter and by noise."""
    squares = sum(float(np.square(amounts - amounts.mean()).sum()) for amounts in (today, before))
    apart = abs(float(today.mean() - before.mean())) / np.sqrt(1.0 / len(today) + 1.0 / len(before))
    degrees = len(today) + len(before) - 2.0
    with_noise = degrees + NOISE_DEGREES, squares + NOISE_DEGREES * noise_variance
    estimates = [(degrees, squares), with_noise] if degrees > 0.0 else [with_noise]
    return max(float(2.0 * student.sf(apart / np.sqrt(max(sum_, TINY) / of), of)) for of, sum_ in estimates)
