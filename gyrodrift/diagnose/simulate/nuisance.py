"""Dependences that no effect of the catalogue has, added to a rate as shapes, so that no effect is bent to them.

Where one of them explains a gap best, the verdict is that the gap is unknown, and what it depends on.
"""

from collections.abc import Callable

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.design_matrix import DesignMatrix

Shape = Callable[[DesignMatrix, np.random.Generator], Floats]
"""A session's design and dice to what is added to its rate, deg/s at size 1, shape (n,)."""


def regressor(name: str) -> Shape:
    """In proportion to one of the columns that no effect of the catalogue depends on."""
    return lambda design, _: design.out_of_catalogue[name]


def swing(period_s: float) -> Shape:
    """A sine over time."""

    def shape(design: DesignMatrix, rng: np.random.Generator) -> Floats:
        t_s = np.arange(design.samples) * design.period_s
        sine: Floats = np.sin(2.0 * np.pi * (t_s / period_s + rng.random()))
        return sine

    return shape


def ripple(order: int) -> Shape:
    """A sine of a multiple of the angle."""

    def shape(design: DesignMatrix, rng: np.random.Generator) -> Floats:
        sine: Floats = np.sin(order * np.deg2rad(design.motion.angle_deg) + 2.0 * np.pi * rng.random())
        return sine

    return shape


def angle_ripple(order: int) -> Shape:
    """What an angle that errs by such a sine looks like from the rate; size is the angle's, in degrees."""

    def shape(design: DesignMatrix, rng: np.random.Generator) -> Floats:
        turn = order * np.deg2rad(design.motion.angle_deg) + 2.0 * np.pi * rng.random()
        slope: Floats = -order * np.deg2rad(design.motion.rate_dps) * np.cos(turn)
        return slope

    return shape
