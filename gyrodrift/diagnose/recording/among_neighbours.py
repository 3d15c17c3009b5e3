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
