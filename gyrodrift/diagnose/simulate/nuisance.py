"""Out-of-catalog models: rate errors that no effect of the catalog produces, so that no effect is fitted to them.

If such a model explains a gap best, the verdict is an unknown cause, and states what the error depends on.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from firmware_sim.effects.effect import Effect
from firmware_sim.effects.recursion import OnePole
from gyrodrift.diagnose.features.columns import WARMING
from gyrodrift.diagnose.features.design_matrix import COLUMNS, DesignMatrix
from gyrodrift.diagnose.features.feature import Feature
from gyrodrift.diagnose.features.regimes import SLOW_DPS
from gyrodrift.diagnose.simulate.candidate import Candidate, Shape, Touches
from gyrodrift.diagnose.simulate.grids import between
from gyrodrift.diagnose.simulate.kinds import LAG
from gyrodrift.values.arrays import Floats

WAVES, GRID = 8, 512
"""Number of cosine waves in a random function, and of grid points between which it is interpolated linearly. Chosen:
accuracy of the kernel."""

WITHIN_FUNCTIONS = frozenset({
    "time", "time_squared", "hinge_low", "hinge_high", "total_angle", "temperature_squared",
    "half_turn_sine", "half_turn_cosine", "half_turn_sine_rate", "half_turn_cosine_rate",
})  # fmt: skip
"""Regressors that are special cases of the random functions, so they need no model of their own."""

ORDERS = (2, 3, 4, 5, 6, 7, 8)
"""Periods per turn of a random function of the angle. Chosen: one period per turn is an effect of the catalog."""

MEMORY_S = 0.2
"""Time constant of correlated noise, s. Chosen: between white noise and a wandering bias. It is white in means of a
second."""


def out_of_catalogue() -> Iterator[Candidate]:
    """Candidates for rate errors outside of the catalog; their names begin with a question mark."""
    for column in COLUMNS:
        if not column.in_catalogue and column.name not in WITHIN_FUNCTIONS:
            yield _linear(column, regressor(column.name))
    for play_c in (1.5, 4.0):  # width of the hysteresis, °C
        yield _linear(WARMING, behind_temperature(play_c), f"play {play_c:g} °C")
    # A delay is an effect of the catalog, a lead is not.
    yield _form("?acceleration", ahead, (-0.01, 0.01), between(0.001, 0.06), group=LAG)
    for name, shape in FUNCTIONS:
        yield _at_random(name, shape, (0.02, 0.5), realisations=12)
    yield _at_random("?wander_rest", with_memory, touches=Touches.VALUES)
    in_motion = "?scatter_moving"
    yield _at_random(in_motion, with_memory_in_motion, variant="in any motion", touches=Touches.VALUES)
    # Standard deviation of the noise divided by the rate.
    by_rate = (0.0003, 0.001, 0.003, 0.01, 0.03)
    yield _at_random(in_motion, in_proportion, by_rate, variant="with the rate", touches=Touches.VALUES)


def regressor(name: str) -> Shape:
    """Shape that is proportional to a column of the design matrix."""
    return lambda design, _: design.regressor(name)


def behind_temperature(play_c: float) -> Shape:
    """Hysteresis: difference between the temperature and a copy that follows it with play, °C; it begins at 0."""

    def shape(design: DesignMatrix, _: np.random.Generator) -> Floats:
        block_c = design.motion.sensor_c[:: design.block]
        followed_c, lags_c = float(block_c[0]), np.empty(len(block_c))
        for index, sensor_c in enumerate(block_c.tolist()):
            followed_c = min(max(followed_c, sensor_c - play_c / 2.0), sensor_c + play_c / 2.0)
            lags_c[index] = sensor_c - followed_c
        samples = np.arange(design.samples)
        lag_c: Floats = np.interp(samples, samples[:: design.block], lags_c)
        return lag_c

    return shape


def ahead(design: DesignMatrix, _: np.random.Generator) -> Floats:
    """Change of a rate that leads by 1 s, to first order: the acceleration, deg/s/s."""
    return np.gradient(design.motion.rate_dps, design.period_s)


def random_function(rng: np.random.Generator, x: Floats, shortest: float, longest: float) -> Floats:
    """Values of a smooth random function at x, with a variance of about 1 and a mean of 0.

    The function is a Gaussian process with a squared exponential kernel, approximated by WAVES random waves (A. Rahimi
    and B. Recht, Random features for large-scale kernel machines, 2007). Its length scale is drawn between `shortest`
    and `longest`, uniformly in the logarithm.
    """
    length = shortest * (longest / shortest) ** rng.random()
    grid = np.linspace(float(x.min()), float(x.max()), GRID)
    waves, phases = rng.standard_normal(WAVES) / length, 2.0 * np.pi * rng.random(WAVES)
    values = np.sqrt(2.0 / WAVES) * np.cos(np.outer(grid, waves) + phases).sum(axis=1)
    at_x: Floats = np.interp(x, grid, values)
    return at_x - float(at_x.mean())


def random_turn(rng: np.random.Generator, angle_deg: Floats) -> Floats:
    """Values of a random periodic function of the angle: a sum of sines with ORDERS periods per turn.

    The orders have random ranks; every rank has half the power of the rank before.
    """
    orders = np.array(ORDERS)
    grid = np.linspace(0.0, 2.0 * np.pi, GRID)
    amplitudes = rng.standard_normal(len(orders)) * 0.5 ** (0.5 * rng.permutation(len(orders)))
    values = (amplitudes * np.sin(np.outer(grid, orders) + 2.0 * np.pi * rng.random(len(orders)))).sum(axis=1)
    at_angles: Floats = np.interp(np.deg2rad(angle_deg % 360.0), grid, values)
    return at_angles


def in_time(design: DesignMatrix, rng: np.random.Generator) -> Floats:
    """Bias as a random function of time."""
    t_s: Floats = np.arange(design.samples, dtype=np.float64) * design.period_s
    return random_function(rng, t_s, 15.0, 200.0)


def in_rate(design: DesignMatrix, rng: np.random.Generator) -> Floats:
    """Rate error as a random function of the rate, without its linear part, and 0 at rest."""
    rate_dps = design.motion.rate_dps
    most_dps = max(float(np.abs(rate_dps).max()), SLOW_DPS)
    error_dps = _without_line(rate_dps, random_function(rng, rate_dps, 0.15 * most_dps, most_dps))
    return error_dps - float(np.median(error_dps[np.abs(rate_dps) <= max(SLOW_DPS, float(np.abs(rate_dps).min()))]))


def in_temperature(design: DesignMatrix, rng: np.random.Generator) -> Floats:
    """Bias as a random function of the temperature, without its linear part, which is an effect of the catalog."""
    sensor_c = design.motion.sensor_c
    return _without_line(sensor_c, random_function(rng, sensor_c, 3.0, 30.0))


def _without_line(x: Floats, values: Floats) -> Floats:
    """Values without the slope of the least-squares line over x."""
    away = x - float(x.mean())
    slope = float(away @ values) / max(float(away @ away), 1e-12)
    return values - slope * away


def in_turns(design: DesignMatrix, rng: np.random.Generator) -> Floats:
    """Bias as a random function of the total angle, as with a twisted cable."""
    return random_function(rng, design.motion.angle_deg / 360.0, 0.5, 20.0)


def in_angle(design: DesignMatrix, rng: np.random.Generator) -> Floats:
    """Bias as a random function of the angle within a turn."""
    return random_turn(rng, design.motion.angle_deg)


def gain_in_angle(design: DesignMatrix, rng: np.random.Generator) -> Floats:
    """Gain error as a random function of the angle within a turn; size 1 is 1 deg/s at 100 deg/s."""
    return random_turn(rng, design.motion.angle_deg) * design.motion.rate_dps / 100.0


def of_angle_error(design: DesignMatrix, rng: np.random.Generator) -> Floats:
    """Rate error by a random error of the encoder's angle; the size is that of the angle error, degrees."""
    error_deg = random_turn(rng, design.motion.angle_deg)
    slope: Floats = -np.gradient(error_deg, design.period_s)
    return slope


def with_memory(design: DesignMatrix, rng: np.random.Generator) -> Floats:
    """Correlated noise: a Gauss-Markov process with the time constant MEMORY_S and a variance of 1."""
    kept = np.exp(-design.period_s / MEMORY_S)
    return OnePole(kept, np.float64(0.0))(np.sqrt(1.0 - kept**2) * rng.standard_normal(design.samples))


def with_memory_in_motion(design: DesignMatrix, rng: np.random.Generator) -> Floats:
    """Correlated noise in motion, 0 at rest."""
    return np.where(np.abs(design.regimes.speed_dps) > SLOW_DPS, with_memory(design, rng), 0.0)


def in_proportion(design: DesignMatrix, rng: np.random.Generator) -> Floats:
    """White noise with a standard deviation equal to the rate."""
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
"""Random functions, by the name of the feature that they change most; sizes are in deg/s."""


def _linear(feature: Feature, shape: Shape, variant: str = "") -> Candidate:
    """Candidate whose response is linear; its sizes are multiples of the relevance threshold of a feature."""
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
    """Candidate with a random shape, simulated at these sizes."""
    sizes = between(points[0], points[-1])
    return replace(_form(name, shape, points, sizes, variant=variant), touches=touches, realisations=realisations)


def _form(
    name: str, shape: Shape, points: Sequence[float] | Floats, sizes: Floats, group: str = "", variant: str = ""
) -> Candidate:
    """Candidate of an out-of-catalog model with a slow deterministic shape."""
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
