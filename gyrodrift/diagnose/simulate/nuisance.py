"""Out-of-catalogue models: dependences that no effect has, added to a rate so that no effect is bent to them.

Where one of them explains a gap best, the verdict is that the gap is unknown, and what it depends on.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from scipy.signal import lfilter

from firmware_sim.effects.effect import Effect
from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.columns import WARMING
from gyrodrift.diagnose.features.design_matrix import COLUMNS, DesignMatrix
from gyrodrift.diagnose.features.feature import Feature
from gyrodrift.diagnose.features.regimes import SLOW_DPS
from gyrodrift.diagnose.simulate.candidate import Candidate, Shape, Touches
from gyrodrift.diagnose.simulate.grids import between
from gyrodrift.diagnose.simulate.kinds import LAG

WAVES, GRID = 8, 512
"""Waves of a random function, and points between which it is straight."""

WITHIN_FUNCTIONS = frozenset({
    "time", "time_squared", "hinge_low", "hinge_high", "total_angle", "temperature_squared",
    "half_turn_sine", "half_turn_cosine", "half_turn_sine_rate", "half_turn_cosine_rate",
})  # fmt: skip
"""Regressors that random functions hold as special cases."""

ORDERS = (2, 3, 4, 5, 6, 7, 8)
"""Parts of a turn; once per turn is an effect of the catalog."""

MEMORY_S = 0.2
"""Time constant of noise that is white beyond a second: between white noise and any wandering of a bias."""


def out_of_catalogue() -> Iterator[Candidate]:
    """Candidates for forms that no effect has; their names begin with a question mark."""
    for column in COLUMNS:
        if not column.in_catalogue and column.name not in WITHIN_FUNCTIONS:
            yield _linear(column, regressor(column.name))
    for play_c in (1.5, 4.0):  # the temperature turns back by so much before a bias with hysteresis follows
        yield _linear(WARMING, behind_temperature(play_c), f"play {play_c:g} °C")
    # A rate that comes late is an effect of the catalog, one that leads is none.
    yield _form("?acceleration", ahead, (-0.01, 0.01), between(0.001, 0.06), group=LAG)
    for name, shape in FUNCTIONS:
        yield _at_random(name, shape, (0.02, 0.5), realisations=12)
    yield _at_random("?wander_rest", with_memory, touches=Touches.VALUES)
    in_motion = "?scatter_moving"
    yield _at_random(in_motion, with_memory_in_motion, variant="in any motion", touches=Touches.VALUES)
    # Standard deviations in parts of the rate.
    by_rate = (0.0003, 0.001, 0.003, 0.01, 0.03)
    yield _at_random(in_motion, in_proportion, by_rate, variant="with the rate", touches=Touches.VALUES)


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
    """Gain of a rate that comes a second early, to first order: its own change."""
    return np.gradient(design.motion.rate_dps, design.period_s)


def random_function(rng: np.random.Generator, x: Floats, shortest: float, longest: float) -> Floats:
    """A smooth function of x whose values have a variance of about 1 and mean 0 over them.

    A Gaussian process with a squared exponential kernel by WAVES random waves (A. Rahimi and B. Recht, Random features
    for large-scale kernel machines, 2007), on a grid. Its length is drawn between two, evenly in its logarithm.
    """
    length = shortest * (longest / shortest) ** rng.random()
    grid = np.linspace(float(x.min()), float(x.max()), GRID)
    waves, phases = rng.standard_normal(WAVES) / length, 2.0 * np.pi * rng.random(WAVES)
    values = np.sqrt(2.0 / WAVES) * np.cos(np.outer(grid, waves) + phases).sum(axis=1)
    found: Floats = np.interp(x, grid, values)
    return found - float(found.mean())


def random_turn(rng: np.random.Generator, angle_deg: Floats) -> Floats:
    """A function of the angle in a turn, of ORDERS parts of it, each of which has half the power of the one before."""
    orders = np.array(ORDERS)
    grid = np.linspace(0.0, 2.0 * np.pi, GRID)
    amplitudes = rng.standard_normal(len(orders)) * 0.5 ** (0.5 * rng.permutation(len(orders)))
    values = (amplitudes * np.sin(np.outer(grid, orders) + 2.0 * np.pi * rng.random(len(orders)))).sum(axis=1)
    found: Floats = np.interp(np.deg2rad(angle_deg % 360.0), grid, values)
    return found


def in_time(design: DesignMatrix, rng: np.random.Generator) -> Floats:
    """A bias that depends on the time."""
    t_s: Floats = np.arange(design.samples, dtype=np.float64) * design.period_s
    return random_function(rng, t_s, 15.0, 200.0)


def in_rate(design: DesignMatrix, rng: np.random.Generator) -> Floats:
    """One that depends on the rate, beside a scale error and a bias."""
    rate_dps = design.motion.rate_dps
    most_dps = max(float(np.abs(rate_dps).max()), SLOW_DPS)
    found = _bent(rate_dps, random_function(rng, rate_dps, 0.15 * most_dps, most_dps))
    return found - float(np.median(found[np.abs(rate_dps) <= max(SLOW_DPS, float(np.abs(rate_dps).min()))]))


def in_temperature(design: DesignMatrix, rng: np.random.Generator) -> Floats:
    """One that bends with the temperature: a straight line is an effect of the catalog."""
    sensor_c = design.motion.sensor_c
    return _bent(sensor_c, random_function(rng, sensor_c, 3.0, 30.0))


def _bent(x: Floats, values: Floats) -> Floats:
    """Without the best straight line."""
    away = x - float(x.mean())
    slope = float(away @ values) / max(float(away @ away), 1e-12)
    return values - slope * away


def in_turns(design: DesignMatrix, rng: np.random.Generator) -> Floats:
    """One that depends on the angle turned in all, as a cable that is twisted."""
    return random_function(rng, design.motion.angle_deg / 360.0, 0.5, 20.0)


def in_angle(design: DesignMatrix, rng: np.random.Generator) -> Floats:
    """One that depends on the angle in a turn."""
    return random_turn(rng, design.motion.angle_deg)


def gain_in_angle(design: DesignMatrix, rng: np.random.Generator) -> Floats:
    """A gain that depends on the angle in a turn; size 1 is deg/s at 100 deg/s."""
    return random_turn(rng, design.motion.angle_deg) * design.motion.rate_dps / 100.0


def of_angle_error(design: DesignMatrix, rng: np.random.Generator) -> Floats:
    """Rate error that an error of the angle looks like; size is that of the angle, degrees."""
    error_deg = random_turn(rng, design.motion.angle_deg)
    slope: Floats = -np.gradient(error_deg, design.period_s)
    return slope


def with_memory(design: DesignMatrix, rng: np.random.Generator) -> Floats:
    """A Gauss-Markov process of MEMORY_S."""
    kept = np.exp(-design.period_s / MEMORY_S)
    noise: Floats = lfilter([np.sqrt(1.0 - kept**2)], [1.0, -kept], rng.standard_normal(design.samples))
    return noise


def with_memory_in_motion(design: DesignMatrix, rng: np.random.Generator) -> Floats:
    """Noise with memory, silent where nothing moves."""
    return np.where(np.abs(design.regimes.speed_dps) > SLOW_DPS, with_memory(design, rng), 0.0)


def in_proportion(design: DesignMatrix, rng: np.random.Generator) -> Floats:
    """White noise as large as the rate."""
    noise: Floats = design.motion.rate_dps * rng.standard_normal(design.samples)
    return noise


FUNCTIONS: tuple[tuple[str, Shape], ...] = (
    ("?wander_20s", in_time),
    ("?hinge_high", in_rate),
    ("?temperature_squared", in_temperature),
    ("?total_angle", in_turns),
    ("?ripple", in_angle),
    ("?half_turn_cosine_rate", gain_in_angle),
    ("?angle_ripple", of_angle_error),
)
"""Random functions by the feature that each moves most; sizes are deg/s."""


def _linear(feature: Feature, shape: Shape, variant: str = "") -> Candidate:
    """A form in proportion to its size; sizes are multiples of the relevance threshold of a feature."""
    up = feature.threshold * between(3.0, 3000.0)
    points = feature.threshold * np.array([-100.0, 100.0])
    return _form(f"?{feature.name}", shape, points, np.concatenate([-up[::-1], up]), variant=variant)


def _at_random(
    name: str,
    shape: Shape,
    points: Sequence[float] = (0.003, 0.01, 0.03, 0.1, 0.3),
    variant: str = "",
    touches: Touches = Touches.SLOW_RATE,
    realisations: int = 4,
) -> Candidate:
    sizes = between(points[0], points[-1])
    return replace(_form(name, shape, points, sizes, variant=variant), touches=touches, realisations=realisations)


def _form(
    name: str, shape: Shape, points: Sequence[float] | Floats, sizes: Floats, group: str = "", variant: str = ""
) -> Candidate:
    return Candidate(
        name,
        variant,
        _no_effect,
        "size",
        np.array(points),
        sizes,
        group or name,
        touches=Touches.SLOW_RATE,
        shape=shape,
    )


def _no_effect(_: float) -> Effect:
    raise LookupError("no effect of the catalogue does this")
