"""Out-of-catalogue models: dependences that no effect has, added to a rate so that no effect is bent to them.

Where one of them explains a gap best, the verdict is that the gap is unknown, and what it depends on.
"""

from collections.abc import Iterator

import numpy as np

from firmware_sim.effects.effect import Effect
from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.design_matrix import COLUMNS, DesignMatrix
from gyrodrift.diagnose.simulate.candidate import Candidate, Hints, Shape
from gyrodrift.diagnose.simulate.grids import between
from gyrodrift.diagnose.simulate.kinds.groups import LAG

THRESHOLDS_SIMULATED = 100.0
THRESHOLDS_LEAST, THRESHOLDS_MOST = 3.0, 3000.0
"""Sizes of regressors, in multiples of their relevance thresholds."""

LEAD_S = 0.01
LEAST_LEAD_S, MOST_LEAD_S = 0.001, 0.06
"""By which the encoder comes late: a rate that comes late is an effect of the catalogue, one that leads is none."""

PERIODIC_POINTS = (0.003, 0.01, 0.03, 0.1, 0.3)
PERIODIC_REALISATIONS = 4
"""Of sines whose phase is left to chance."""


def out_of_catalogue(hints: Hints) -> Iterator[Candidate]:
    """All of them; their names begin with a question mark."""
    for column in COLUMNS:
        if not column.in_catalogue:
            yield _of_regressor(column.name, column.threshold)
    yield _lead()
    yield _of_sine("?swing", in_time(hints.period_s))
    yield _of_sine("?ripple", in_angle(hints.turn_order))
    yield _of_sine("?angle_ripple", of_angle_error(hints.angle_turn_order))


def regressor(name: str) -> Shape:
    """In proportion to one of the columns that no effect of the catalogue depends on."""
    return lambda design, _: design.regressor(name)


def ahead(design: DesignMatrix, _: np.random.Generator) -> Floats:
    """What a rate gains that comes a second early, to first order: its own change."""
    return np.gradient(design.motion.rate_dps, design.period_s)


def in_time(period_s: float) -> Shape:
    """A sine over time."""

    def shape(design: DesignMatrix, rng: np.random.Generator) -> Floats:
        t_s = np.arange(design.samples) * design.period_s
        sine: Floats = np.sin(2.0 * np.pi * (t_s / period_s + rng.random()))
        return sine

    return shape


def in_angle(order: int) -> Shape:
    """A sine of a multiple of the angle."""

    def shape(design: DesignMatrix, rng: np.random.Generator) -> Floats:
        sine: Floats = np.sin(order * np.deg2rad(design.motion.angle_deg) + 2.0 * np.pi * rng.random())
        return sine

    return shape


def of_angle_error(order: int) -> Shape:
    """What an angle that errs by such a sine looks like from the rate; size is the angle's, in degrees."""

    def shape(design: DesignMatrix, rng: np.random.Generator) -> Floats:
        turn = order * np.deg2rad(design.motion.angle_deg) + 2.0 * np.pi * rng.random()
        slope: Floats = -order * np.deg2rad(design.motion.rate_dps) * np.cos(turn)
        return slope

    return shape


def _of_regressor(name: str, threshold: float) -> Candidate:
    up = threshold * between(THRESHOLDS_LEAST, THRESHOLDS_MOST)
    return Candidate(
        name=f"?{name}",
        variant="",
        make=_no_effect,
        parameter="size",
        grid_points=threshold * np.array([-THRESHOLDS_SIMULATED, THRESHOLDS_SIMULATED]),
        sizes=np.concatenate([-up[::-1], up]),
        group=f"?{name}",
        shape=regressor(name),
    )


def _lead() -> Candidate:
    return Candidate(
        name="?acceleration",
        variant="",
        make=_no_effect,
        parameter="size",
        grid_points=np.array([-LEAD_S, LEAD_S]),
        sizes=between(LEAST_LEAD_S, MOST_LEAD_S),
        group=LAG.name,
        shape=ahead,
    )


def _of_sine(name: str, shape: Shape) -> Candidate:
    return Candidate(
        name=name,
        variant="",
        make=_no_effect,
        parameter="size",
        grid_points=np.array(PERIODIC_POINTS),
        sizes=between(PERIODIC_POINTS[0], PERIODIC_POINTS[-1]),
        group=name,
        realisations=PERIODIC_REALISATIONS,
        shape=shape,
    )


def _no_effect(_: float) -> Effect:
    raise LookupError("no effect of the catalogue does this")
