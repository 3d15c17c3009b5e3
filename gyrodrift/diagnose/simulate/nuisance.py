"""Out-of-catalogue models: dependences that no effect has, added to a rate so that no effect is bent to them.

Where one of them explains a gap best, the verdict is that the gap is unknown, and what it depends on.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from scipy.signal import lfilter

from firmware_sim.effects.effect import Effect
from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.design_matrix import COLUMNS, DesignMatrix
from gyrodrift.diagnose.features.regimes import SLOW_DPS
from gyrodrift.diagnose.features.warming import WARMING
from gyrodrift.diagnose.simulate.candidate import Candidate, Hints, Shape, Touches
from gyrodrift.diagnose.simulate.grids import between
from gyrodrift.diagnose.simulate.kinds.groups import LAG

THRESHOLDS_SIMULATED = 100.0
THRESHOLDS_LEAST, THRESHOLDS_MOST = 3.0, 3000.0
"""Sizes of regressors, in multiples of their relevance thresholds."""

LEAD_S = 0.01
LEAST_LEAD_S, MOST_LEAD_S = 0.001, 0.06
"""By which the encoder comes late: a rate that comes late is an effect of the catalogue, one that leads is none."""

RANDOM_POINTS = (0.003, 0.01, 0.03, 0.1, 0.3)
REALISATIONS = 4
"""Of what is left to chance: the phase of a sine, and all noise."""

MEMORY_S = 0.2
"""Of noise that is not white within a second, and white beyond: between white noise and any wandering of a bias."""

PLAYS_C = (1.5, 4.0)
"""By how far the temperature turns back before a bias with hysteresis follows it."""

BY_RATE_POINTS = (0.0003, 0.001, 0.003, 0.01, 0.03)
"""Standard deviations of a noise that grows with the rate, in parts of it."""


def out_of_catalogue(hints: Hints) -> Iterator[Candidate]:
    """All of them; their names begin with a question mark."""
    for column in COLUMNS:
        if not column.in_catalogue:
            yield _of_regressor(column.name, column.threshold)
    for play_c in PLAYS_C:
        yield _with_play(play_c)
    yield _lead()
    yield _at_random("?swing", in_time(hints.period_s))
    yield _at_random("?ripple", in_angle(hints.turn_order))
    yield _at_random("?angle_ripple", of_angle_error(hints.angle_turn_order))
    yield _noise("?wander_rest", "", with_memory)
    yield _noise("?scatter_moving", "in any motion", with_memory_in_motion)
    yield _noise("?scatter_moving", "with the rate", in_proportion, BY_RATE_POINTS)


def regressor(name: str) -> Shape:
    """In proportion to one of the columns that no effect of the catalogue depends on."""
    return lambda design, _: design.regressor(name)


def behind_temperature(play_c: float) -> Shape:
    """How far the temperature has gone from one that follows it with play, at rest with it at first; hysteresis, °C."""

    def shape(design: DesignMatrix, _: np.random.Generator) -> Floats:
        every_c = design.motion.sensor_c[:: design.block]
        held_c, lags_c = float(every_c[0]), np.empty(len(every_c))
        for number, sensor_c in enumerate(every_c.tolist()):
            held_c = min(max(held_c, sensor_c - play_c / 2.0), sensor_c + play_c / 2.0)
            lags_c[number] = sensor_c - held_c
        samples = np.arange(design.samples)
        lag_c: Floats = np.interp(samples, samples[:: design.block], lags_c)
        return lag_c

    return shape


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


def with_memory(design: DesignMatrix, rng: np.random.Generator) -> Floats:
    """A Gauss-Markov process of MEMORY_S."""
    kept = np.exp(-design.period_s / MEMORY_S)
    noise: Floats = lfilter([np.sqrt(1.0 - kept**2)], [1.0, -kept], rng.standard_normal(design.samples))
    return noise


def with_memory_in_motion(design: DesignMatrix, rng: np.random.Generator) -> Floats:
    """The same, silent where nothing moves."""
    return np.where(np.abs(design.regimes.speed_dps) > SLOW_DPS, with_memory(design, rng), 0.0)


def in_proportion(design: DesignMatrix, rng: np.random.Generator) -> Floats:
    """White noise as large as the rate."""
    noise: Floats = design.motion.rate_dps * rng.standard_normal(design.samples)
    return noise


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
        touches=Touches.SLOW_RATE,
        shape=regressor(name),
    )


def _with_play(play_c: float) -> Candidate:
    every = _of_regressor(WARMING.name, WARMING.threshold)
    return replace(every, variant=f"play {play_c:g} °C", shape=behind_temperature(play_c))


def _lead() -> Candidate:
    return Candidate(
        name="?acceleration",
        variant="",
        make=_no_effect,
        parameter="size",
        grid_points=np.array([-LEAD_S, LEAD_S]),
        sizes=between(LEAST_LEAD_S, MOST_LEAD_S),
        group=LAG.name,
        touches=Touches.SLOW_RATE,
        shape=ahead,
    )


def _at_random(name: str, shape: Shape, points: Sequence[float] = RANDOM_POINTS) -> Candidate:
    return Candidate(
        name=name,
        variant="",
        make=_no_effect,
        parameter="size",
        grid_points=np.array(points),
        sizes=between(points[0], points[-1]),
        group=name,
        touches=Touches.SLOW_RATE,
        realisations=REALISATIONS,
        shape=shape,
    )


def _noise(name: str, variant: str, shape: Shape, points: Sequence[float] = RANDOM_POINTS) -> Candidate:
    """What shows from sample to sample, too."""
    return replace(_at_random(name, shape, points), variant=variant, touches=Touches.VALUES)


def _no_effect(_: float) -> Effect:
    raise LookupError("no effect of the catalogue does this")
