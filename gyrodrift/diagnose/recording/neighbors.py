"""Residuals of samples from the samples before and after them, at rest and in motion."""

import numpy as np

from gyrodrift.values.arrays import Floats, Mask


def cubic_residual(values: Floats) -> Floats:
    """(n,) difference of every value from the cubic through the two values before it and the two after it.

    The cubic follows quick motion. Beside an outlier the residual is two thirds of the outlier.
    """
    padded = np.pad(values, 2, mode="edge")
    residual: Floats = values - (4.0 * (padded[1:-3] + padded[3:-1]) - (padded[:-4] + padded[4:])) / 6.0
    return residual


def steepest_neighbor_step(values: Floats) -> Floats:
    """(n,) largest step between two successive values near every value, without the steps to and from the value."""
    steps = np.abs(np.diff(np.pad(values, 3, mode="edge")))
    before, after = np.maximum(steps[:-5], steps[1:-4]), np.maximum(steps[4:-1], steps[5:])
    steepest: Floats = np.maximum(before, after)
    return steepest


def is_isolated(residual: Floats) -> Mask:
    """(n,) whether the cubic residual of a value is 1.25 times larger than those of both neighbors.

    Beside an outlier the residual is two thirds of it. At an edge of the rate both sides have the same residual.
    """
    size = np.pad(np.abs(residual), 1)
    isolated: Mask = size[1:-1] > 1.25 * np.maximum(size[:-2], size[2:])
    return isolated
