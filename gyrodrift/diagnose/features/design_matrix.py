"""What the residuals of a session are held against: the motion, temperature and time of the recording itself.

The same design serves the recording and every simulation driven through its motion, so that a difference of their
features is a difference of what was measured.
"""

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import correlate1d, gaussian_filter1d, maximum_filter1d, minimum_filter1d

from gyrodrift.arrays import Floats, Mask
from gyrodrift.diagnose.features.feature import Feature
from gyrodrift.diagnose.recording.motion import ReplayedMotion
from gyrodrift.diagnose.recording.outliers import Cleaned

BLOCK_S = 1.0
"""Over a second an encoder of 0.01 degrees knows the mean rate to some 0.004 deg/s."""

REST_DPS, SLOW_DPS, FAST_DPS = 0.5, 2.0, 40.0
REST_EDGE_S = 0.6
"""At rest is what is slower than REST_DPS for so long before and after."""

QUICK_DPS, STEADY_DPS = 1.0, 0.05
"""From one sample to the next the rate changes by more than noise does, or by next to nothing."""

MASK_SMOOTH_S = 0.15
TURN_DPS = 1.0
"""A direction is one that was gone in faster than this."""

EVEN_DPSS = 0.5
"""A second is even when the mean rate changes by less than this, deg/s/s."""

MEMORY_S = 10.0
HINGES_DPS = (60.0, 120.0)


@dataclass(frozen=True, slots=True)
class Column:
    """A regressor of the block residuals, what an error of it is called, and the coefficient too small to matter."""

    feature: Feature
    floor: float


def _column(name: str, stage: str, regime: str, floor: float, says: str) -> Column:
    return Column(Feature(name, stage, regime, says), floor)


COLUMNS = (
    _column("rate", "sensor", "moving", 3e-4, "the rate is too high or too low in both directions"),
    _column("abs_rate", "sensor", "moving", 1.5e-4, "the rate is too high in one direction and too low in the other"),
    _column("rate_squared", "sensor", "fast", 3e-7, "the bias grows with the square of the rate"),
    _column("rate_cubed", "sensor", "fast", 4e-10, "the gain changes with the rate"),
    _column("hinge_low", "sensor", "fast", 4e-4, "the gain changes above 60 deg/s"),
    _column("hinge_high", "sensor", "fast", 6e-4, "the gain changes above 120 deg/s"),
    _column("temperature", "environment", "warm", 6e-4, "the bias follows the temperature"),
    _column("temperature_squared", "environment", "warm", 6e-5, "the bias bends with the temperature"),
    _column("temperature_rate", "environment", "warm", 3e-5, "the gain follows the temperature"),
    _column("decay_fast", "environment", "early", 6e-3, "the bias decays in the first minute after power-on"),
    _column("decay_slow", "environment", "early", 6e-3, "the bias decays over minutes after power-on"),
    _column("time", "sensor", "late", 6e-3, "the bias drifts from the beginning to the end"),
    _column("time_squared", "sensor", "late", 6e-3, "the bias drifts and comes back"),
    _column("turn_sine", "sensor", "moving", 2e-3, "the bias changes once per turn"),
    _column("turn_cosine", "sensor", "moving", 2e-3, "the bias changes once per turn"),
    _column("turn_sine_rate", "encoder", "moving", 2e-4, "the angle errs once per turn"),
    _column("turn_cosine_rate", "encoder", "moving", 2e-4, "the angle errs once per turn"),
    _column("half_turn_sine", "sensor", "moving", 2e-3, "the bias changes twice per turn"),
    _column("half_turn_cosine", "sensor", "moving", 2e-3, "the bias changes twice per turn"),
    _column("half_turn_sine_rate", "encoder", "moving", 2e-4, "the angle errs twice per turn"),
    _column("half_turn_cosine_rate", "encoder", "moving", 2e-4, "the angle errs twice per turn"),
    _column("acceleration", "sensor", "accelerating", 3e-4, "the rate lags or leads when it changes"),
    _column("abs_acceleration", "sensor", "accelerating", 2e-5, "the bias grows with any acceleration"),
    _column("reversal", "platform", "reversing", 4e-3, "the angle comes late after a reversal"),
    _column("direction", "sensor", "rest", 2e-3, "the bias depends on the direction last gone in"),
    _column("moving", "sensor", "moving", 2e-3, "the bias is another one while it moves"),
    _column("after_turn", "sensor", "reversing", 3e-3, "the bias is shifted after a reversal and recovers"),
    _column("total_angle", "platform", "always", 1e-3, "the bias follows the angle turned in all"),
    _column("time_rate", "sensor", "late", 4e-4, "the gain drifts with time"),
)
"""In the order in which they are made orthogonal: what two of them share counts for the first."""

SLOW_COLUMNS = frozenset(
    {
        "temperature",
        "temperature_squared",
        "decay_fast",
        "decay_slow",
        "time",
        "time_squared",
        "direction",
        "moving",
        "after_turn",
        "total_angle",
    }
)
"""What a bias that wanders by itself may be taken for."""

STRANGE_COLUMNS = frozenset(
    {
        "hinge_low",
        "hinge_high",
        "half_turn_sine",
        "half_turn_cosine",
        "half_turn_sine_rate",
        "half_turn_cosine_rate",
        "abs_acceleration",
        "direction",
        "moving",
        "after_turn",
        "total_angle",
        "time_rate",
        "time",
    }
)
"""On which no effect of the catalogue depends by itself."""

NEW_SHARE = 1e-3
"""A column that is made of those before it but for less than this says nothing new."""

CONSTANT = 1
"""The bias is calibration: the first column, and no feature."""


@dataclass(frozen=True, slots=True)
class Design:
    """The motion of a session, what it did when, and an orthonormal basis of its regressors.

    block_at_rest, block_is_even
        Blocks that rest, and those that rest or turn steadily.
    samples, period_s, block
        Length of the grid, distance in s, samples in a block.
    at_rest, is_slow, is_fast, is_quick, is_steady
        What the device did at each sample, shape (n,).
    speed_dps, block_rate_dps
        Of samples and of blocks.
    quick_basis
        Shape (blocks, some): a constant and the columns that no slow bias can be taken for, orthonormal.
    basis, floors
        Shape (blocks, columns): regressors made orthonormal; (columns,): floors in units of the coefficients on them.
    strange
        Of STRANGE_COLUMNS: the regressor at each sample, shape (n,).
    lag_basis, lag_floors
        The same for what the rate does within a second, shape (n, columns).
    warming_basis, warming_floors
        The same for the change of the temperature from one mean of WARMING_BLOCKS to the next.
    turn_basis, turn_rate_basis
        Of sines of multiples of the angle, and of these times the rate: shape (blocks, some), orthonormal.
    """

    motion: ReplayedMotion
    is_coarse: bool
    samples: int
    period_s: float
    block: int
    at_rest: Mask
    is_slow: Mask
    is_fast: Mask
    is_quick: Mask
    is_steady: Mask
    speed_dps: Floats
    block_rate_dps: Floats
    block_at_rest: Mask
    block_is_even: Mask
    quick_basis: Floats
    basis: Floats
    floors: Floats
    strange: dict[str, Floats]
    lag_basis: Floats
    lag_floors: Floats
    warming_basis: Floats
    warming_floors: Floats
    turn_basis: Floats
    turn_rate_basis: Floats


def design_of(real: Cleaned) -> Design:
    """The design of a recording."""
    motion = real.motion
    period_s = real.recording.period_s
    samples = len(motion.rate_dps)
    block = max(1, round(BLOCK_S / period_s))
    speed_dps = gaussian_filter1d(motion.rate_dps, MASK_SMOOTH_S / period_s)
    edge = 2 * round(REST_EDGE_S / period_s) + 1
    at_rest: Mask = maximum_filter1d(np.abs(speed_dps), edge) < REST_DPS
    slowest = minimum_filter1d(np.abs(speed_dps), block)
    fastest = maximum_filter1d(np.abs(speed_dps), block)
    columns = _columns(motion, speed_dps)
    regressors = np.column_stack([means(column, block) for column in columns])
    basis, floors = _orthonormal(regressors, np.array([column.floor for column in COLUMNS]), CONSTANT)
    lag_basis, lag_floors = _lag_basis(motion, real.encoder_deg)
    warming_basis, warming_floors = _warming_basis(motion, block)
    block_rate_dps = means(motion.rate_dps, block)
    return Design(
        motion=motion,
        is_coarse=real.is_coarse,
        samples=samples,
        period_s=period_s,
        block=block,
        at_rest=at_rest,
        is_slow=(slowest > SLOW_DPS) & (fastest < FAST_DPS),
        is_fast=slowest > FAST_DPS,
        is_quick=np.abs(np.gradient(speed_dps)) > QUICK_DPS,
        is_steady=~at_rest & (np.abs(np.gradient(speed_dps)) < STEADY_DPS),
        speed_dps=speed_dps,
        block_rate_dps=block_rate_dps,
        block_at_rest=means(at_rest.astype(np.float64), block) > 0.99,
        block_is_even=np.abs(np.gradient(block_rate_dps)) < EVEN_DPSS,
        quick_basis=_quick_basis(regressors),
        basis=basis,
        floors=floors,
        strange={
            column.feature.name: values
            for column, values in zip(COLUMNS, columns[CONSTANT:], strict=True)
            if column.feature.name in STRANGE_COLUMNS
        },
        lag_basis=lag_basis,
        lag_floors=lag_floors,
        warming_basis=warming_basis,
        warming_floors=warming_floors,
        turn_basis=_turns(motion, np.ones(samples), block),
        turn_rate_basis=_turns(motion, motion.rate_dps, block),
    )


def means(values: Floats, points: int) -> Floats:
    """Means of as many whole blocks as there are."""
    count = len(values) // points
    out: Floats = values[: count * points].reshape(count, points).mean(axis=1)
    return out


def smoothed_difference(encoder_deg: Floats, period_s: float) -> Floats:
    """Rate of the encoder through the same Gaussian as `smoothed` puts a rate through.

    Gaussian derivatives of the angle itself would leak: it is thousands of degrees, and their weights end somewhere.
    """
    return smoothed(correlate1d(encoder_deg, SIXTH_ORDER, mode="nearest") / period_s, period_s)


def smoothed(rate_dps: Floats, period_s: float) -> Floats:
    """A rate through a Gaussian of LAG_SMOOTH_S."""
    rate: Floats = gaussian_filter1d(rate_dps, LAG_SMOOTH_S / period_s)
    return rate


LAG_SMOOTH_S = 0.02
SIXTH_ORDER = np.array([-1.0, 9.0, -45.0, 0.0, 45.0, -9.0, 1.0]) / 60.0
"""Central difference over seven points: a tone of a tenth of the sample rate comes out 0.05 % too weak."""

WARMING_BLOCKS = 20
WARMING_FEATURES = (Feature("warming", "environment", "warm", "the bias changes when the temperature changes"),)
WARMING_FLOOR, LEAST_WARMING_DPS = 6e-4, 4e-3
"""A bias that wanders by itself may go along with the temperature, but its steps do not go along with each of its."""

LAG_CONSTANTS = 3
LAG_FEATURES = (
    Feature("lag", "sensor", "accelerating", "the rate lags behind the encoder"),
    Feature("lag_bend", "sensor", "accelerating", "fast changes of the rate are weakened or strengthened"),
    Feature("lag_twist", "sensor", "accelerating", "the lag depends on how fast the rate changes"),
)
LAG_FLOORS = (3e-4, 8e-6, 1e-7)
"""0.3 ms, and what belongs to it in higher orders: s, s², s³."""


def _lag_basis(motion: ReplayedMotion, encoder_deg: Floats) -> tuple[Floats, Floats]:
    rate_dps = smoothed_difference(encoder_deg, motion.period_s)
    derivatives = [rate_dps]
    for _ in LAG_FEATURES:
        derivatives.append(np.gradient(derivatives[-1], motion.period_s))
    columns = np.column_stack([np.ones(len(rate_dps)), rate_dps, np.abs(rate_dps), *derivatives[1:]])
    return _orthonormal(columns, np.array(LAG_FLOORS), LAG_CONSTANTS)


def _warming_basis(motion: ReplayedMotion, block: int) -> tuple[Floats, Floats]:
    steps_c = np.diff(means(motion.sensor_c, block * WARMING_BLOCKS))[:, None]
    basis, floors = _orthonormal(steps_c, np.array([WARMING_FLOOR]), 0)
    return basis, np.hypot(floors, LEAST_WARMING_DPS)


TURN_ORDERS = (3, 8)
"""Parts of a turn; halves and wholes are regressors."""


def _turns(motion: ReplayedMotion, weight: Floats, block: int) -> Floats:
    once = np.exp(1j * np.deg2rad(motion.angle_deg))
    columns = []
    turned = weight * once**2
    for _ in range(TURN_ORDERS[0], TURN_ORDERS[1] + 1):
        turned = turned * once
        columns += [means(turned.real, block), means(turned.imag, block)]
    basis, _ = _orthonormal(np.column_stack(columns), np.ones(len(columns)), 0)
    return basis


def _orthonormal(columns: Floats, floors: Floats, dropped: int) -> tuple[Floats, Floats]:
    """An orthonormal basis without its first columns, and how much of it floor-sized coefficients make, (columns,)."""
    norms = np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
    basis, triangle = np.linalg.qr(columns / norms)
    amounts = triangle[dropped:, dropped:] * (norms[dropped:] * floors)
    is_there = np.abs(np.diag(triangle))[dropped:] > NEW_SHARE
    basis = basis[:, dropped:] * np.sign(np.diag(triangle)[dropped:]) * is_there
    return basis, np.linalg.norm(amounts, axis=1)


def _quick_basis(regressors: Floats) -> Floats:
    kept = [0, *(number for number, c in enumerate(COLUMNS, CONSTANT) if c.feature.name not in SLOW_COLUMNS)]
    chosen = regressors[:, kept]
    basis, triangle = np.linalg.qr(chosen / np.maximum(np.linalg.norm(chosen, axis=0), 1e-300))
    return basis * (np.abs(np.diag(triangle)) > NEW_SHARE)


def _columns(motion: ReplayedMotion, speed_dps: Floats) -> list[Floats]:
    """A constant and everything in COLUMNS at each sample, shape (n,) each."""
    rate_dps, period_s = motion.rate_dps, motion.period_s
    t_s = np.arange(len(rate_dps)) * period_s
    powered_s = t_s + motion.powered_s
    share = t_s / t_s[-1] - 0.5
    warm_c = motion.sensor_c - motion.sensor_c.mean()
    turn = np.deg2rad(motion.angle_deg)
    way = _last_direction(speed_dps)
    acceleration = np.gradient(speed_dps, period_s)
    since_s = _since_change(way, period_s)
    return [
        np.ones(len(t_s)),
        rate_dps,
        np.abs(rate_dps),
        rate_dps**2,
        rate_dps**3,
        *(np.sign(rate_dps) * np.maximum(np.abs(rate_dps) - hinge, 0.0) for hinge in HINGES_DPS),
        warm_c,
        warm_c**2,
        warm_c * rate_dps,
        np.exp(-powered_s / 40.0),
        np.exp(-powered_s / 160.0),
        share,
        share**2,
        np.sin(turn),
        np.cos(turn),
        np.sin(turn) * rate_dps,
        np.cos(turn) * rate_dps,
        np.sin(2.0 * turn),
        np.cos(2.0 * turn),
        np.sin(2.0 * turn) * rate_dps,
        np.cos(2.0 * turn) * rate_dps,
        acceleration,
        np.abs(np.gradient(smoothed(rate_dps, period_s), period_s)),
        np.gradient(way, period_s),
        way,
        (np.abs(speed_dps) > SLOW_DPS).astype(np.float64),
        way * np.exp(-since_s / MEMORY_S),
        motion.angle_deg / 360.0,
        share * rate_dps,
    ]


def _last_direction(speed_dps: Floats) -> Floats:
    """+1 or −1 as it last went, 0 before it first did; shape (n,)."""
    goes = np.abs(speed_dps) > TURN_DPS
    place = np.maximum.accumulate(np.where(goes, np.arange(len(speed_dps)), -1))
    return np.where(place >= 0, np.sign(speed_dps[place]), 0.0)


def _since_change(way: Floats, period_s: float) -> Floats:
    """Time since the direction changed last, s; shape (n,)."""
    changed = np.concatenate([[True], np.diff(way) != 0.0])
    place = np.arange(len(way))
    since: Floats = (place - np.maximum.accumulate(np.where(changed, place, 0))).astype(np.float64) * period_s
    return since
