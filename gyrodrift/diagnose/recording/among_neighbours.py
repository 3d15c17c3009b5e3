"""By how much single samples are off those before and after them, in motion as at rest."""

import numpy as np

from gyrodrift.arrays import Floats, Mask


def off_cubic(values: Floats) -> Floats:
    """By how much each of some values is off the cubic through the two before it and the two after it, shape (n,).

    It follows a quick motion; beside an outlier it is off by two thirds of it.
    """
    padded = np.pad(values, 2, mode="edge")
    off: Floats = values - (4.0 * (padded[1:-3] + padded[3:-1]) - (padded[:-4] + padded[4:])) / 6.0
    return off


def steepest_beside(values: Floats) -> Floats:
    """The largest step from one value to the next beside each of them, without those from it and to it, shape (n,)."""
    steps = np.abs(np.diff(np.pad(values, 3, mode="edge")))
    before, after = np.maximum(steps[:-5], steps[1:-4]), np.maximum(steps[4:-1], steps[5:])
    steepest: Floats = np.maximum(before, after)
    return steepest


def stands_alone(off: Floats) -> Mask:
    """Which are further off a cubic than those beside them, as both sides of an edge are not, shape (n,)."""
    size = np.pad(np.abs(off), 1)
    # Beside an outlier a cubic is off by two thirds of it; both sides of an edge are off alike.
    alone: Mask = size[1:-1] > 1.25 * np.maximum(size[:-2], size[2:])
    return alone


def held_on_a_slope(rate_dps: Floats, sigma_dps: float) -> Mask:
    """Which samples repeat the one before them while the rate changes, shape (n,): a link or a sensor held it.

    The rate went on before and after. Where it only goes on after, the last sample of a rest may repeat one by chance.

    sigma_dps
        White noise of a sample.
    """
    off_dps = np.abs(off_cubic(rate_dps))
    steps_dps = np.diff(np.pad(rate_dps, (2, 1), mode="edge"))
    before_dps, to_it_dps, after_dps = steps_dps[:-2], steps_dps[1:-1], steps_dps[2:]
    # A held sample is off by one step; the steps before and after it are one and two.
    went_on = np.minimum(np.abs(before_dps), np.abs(after_dps)) > 0.5 * off_dps
    # Seven standard deviations of a sample, five of what a cubic through four of them leaves.
    held: Mask = (to_it_dps == 0.0) & (off_dps > 7.0 * sigma_dps) & went_on & (before_dps * after_dps > 0.0)
    return held
