"""Whether a cause is new since a baseline: how much of it each recording shows, and Student's test between two sets.

A device varies from one recording to the next most of all in what effects do: its gain, its bias, its delay. How far
single features scatter does not say that they do so together. The amount of one effect in each recording does, in its
own unit, whatever the motion: two sets of amounts are compared (Student, The probable error of a mean, 1908).
"""

import numpy as np
from scipy.stats import t as student

from gyrodrift.arrays import Floats

CHANCE = 0.05
"""Probability at which two sets of amounts differ by chance: as often as a diagnosis may raise a false alarm. What is
asked was chosen among all effects, but explains the features of the later set by itself already. Of three recordings
beside two that show none of it, 0.01 would ask for amounts that are alike to a quarter."""

NOISE_DEGREES = 2.0
"""Degrees of freedom for which the variance counts that amounts have by the noise of features: it is an upper bound,
since features err together, and few recordings say little of their own (Smyth, Linear models and empirical Bayes
methods, 2004)."""

TINY = 1e-12
"""Least square of a change, in units of sigma: an effect that a recording cannot show has no amount there."""


def amounts_of(differences: Floats, changes: Floats, sigma: Floats) -> Floats:
    """(sessions,) how many times each recording shows a change, by weighted least squares.

    differences, changes
        (sessions, F) features of recordings less those of the rig, and what a cause changes them by.
    sigma
        (F,) what each feature scatters by.
    """
    weighted = changes / np.square(sigma)
    found: Floats = (weighted * differences).sum(axis=1) / np.maximum((weighted * changes).sum(axis=1), TINY)
    return found


def amplitudes_of(differences: Floats, quadratures: tuple[Floats, Floats], sigma: Floats) -> Floats:
    """(sessions,) the same of what has a phase of its own in each recording, whatever that is: never below zero.

    quadratures
        (sessions, F) each: what a cause changes the features by at phases of 0 and 90 degrees.
    """
    columns, wanted = np.stack(quadratures, axis=-1) / sigma[:, None], differences / sigma
    parts = [np.linalg.lstsq(own, left)[0] for own, left in zip(columns, wanted, strict=True)]
    found: Floats = np.hypot(*np.transpose(parts))
    return found


def noise_variance_of(changes: Floats, sigma: Floats) -> float:
    """Of an amount, where features scatter by sigma and independently."""
    return float(1.0 / max(np.square(changes / sigma).sum(axis=1).mean(), TINY))


def chance_of(today: Floats, before: Floats, noise_variance: float) -> float:
    """Probability that two sets of amounts of one device differ by so much: by how they scatter, and by noise, too."""
    squares = sum(float(np.square(each - each.mean()).sum()) for each in (today, before))
    apart = abs(float(today.mean() - before.mean())) / np.sqrt(1.0 / len(today) + 1.0 / len(before))
    degrees = len(today) + len(before) - 2.0
    with_noise = degrees + NOISE_DEGREES, squares + NOISE_DEGREES * noise_variance
    known = [(degrees, squares), with_noise] if degrees > 0.0 else [with_noise]
    return max(float(2.0 * student.sf(apart / np.sqrt(max(sum_, TINY) / of), of)) for of, sum_ in known)
