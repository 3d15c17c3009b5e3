"""Rest candidates: windows of blocks in which gyro and accelerometer keep their means (Skog et al., SHOE, 2010)."""

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from gyrodrift.filters.attitude.block import RAD, Integrals
from gyrodrift.filters.attitude.predict import GRAVITY
from gyrodrift.filters.restlevel.bias_state import Hypothesis
from gyrodrift.values.arrays import Floats

GYRO_SPREAD = 0.15 * RAD
ACCEL_SPREAD = 0.07
"""Limits of the standard deviation of block means in a quiet rest, rad/s and m/s².
Measured: recordings of five rigs, median heading error."""

GRAVITY_GATE = 0.8
"""Largest distance of the mean acceleration from gravity, m/s²: biases of cheap parts. Measured: as above."""

FASTEST_BRIEF = 2.0 * RAD
"""Highest bias that a brief rest shows, rad/s. Measured: as above."""

FASTEST_START = 4.0 * RAD
"""Likewise at power-on, where rests are more frequent. Chosen: three standard deviations of raw parts."""

LONGEST = 40
"""Blocks that are kept. Derived: the longest kind of rest, `LONG_NOISY`."""


class RestKind(NamedTuple):
    """Length of a window in blocks, factors on the limits of a quiet rest, and accuracy of the bias it shows.

    blocks
        Length.
    gyro, accel
        Factors on `GYRO_SPREAD` and `ACCEL_SPREAD`.
    bias
        Factor on the error of the mean.
    """

    blocks: int
    gyro: float
    accel: float
    bias: float


QUIET = RestKind(10, 1.0, 1.0, 1.0)
BRIEF = RestKind(4, 0.4, 0.5, 4.0)
NOISY = RestKind(20, 2.5, 2.0, 2.0)
LONG_NOISY = RestKind(40, 5.0, 3.0, 3.0)
KINDS = (QUIET, BRIEF, NOISY, LONG_NOISY)
"""In the order of the search. A brief rest is the moment after power-on before a hand takes the device. Noisy rests
have running motors, or a hand that holds. Measured: as above."""


class RestCandidate(NamedTuple):
    """A window that looks still.

    kind
        Kind of rest.
    gyro, gyro_var
        Mean rates (3), rad/s, and the variances of block means (3).
    accel
        Mean acceleration (3), m/s²; zero without an accelerometer.
    """

    kind: RestKind
    gyro: Floats
    gyro_var: Floats
    accel: Floats

    @property
    def up(self) -> Floats:
        """Unit vector (3) of the mean acceleration; zero without an accelerometer."""
        norm = float(np.sqrt(self.accel @ self.accel))
        return self.accel / norm if norm > 0.0 else np.zeros(3)


@dataclass(slots=True)
class Windows:
    """Means of the last blocks, twice, so that each window is contiguous.

    rows
        Rates (3) and accelerations (3) in units of their limits.
    blocks
        Blocks in the windows.
    total
        Blocks since the first sample.
    is_blind
        The blocks have no acceleration.
    """

    rows: Floats = field(default_factory=lambda: np.zeros((2 * LONGEST, 6)))
    blocks: int = 0
    total: int = 0
    is_blind: bool = False


@dataclass(slots=True)
class Segment:
    """Present or last rest candidate.

    blocks
        Length of the window that was found last; 0 without a candidate.
    since, ago
        Blocks since the last update, and since its end.
    seconds
        Time since the candidate was found.
    gyro
        Mean rates (3) where it was found, rad/s.
    up
        Vertical (3) in the sensor where it was found.
    level
        Mean rate about the vertical, rad/s, before the newest blocks.
    level_blocks
        Blocks in a row that have this rate.
    rest
        Most probable rest, about the vertical: its bias, deg/s, and the slide of that bias.
    undone
        Change of the biases about the vertical at a gradual end, rad/s.
    ended_gradually
        The rate left the segment slowly.
    """

    blocks: int = 0
    since: int = 0
    ago: int = 0
    seconds: float = 0.0
    gyro: Floats = field(default_factory=lambda: np.zeros(3))
    up: Floats = field(default_factory=lambda: np.zeros(3))
    level: float = 0.0
    level_blocks: int = 0
    rest: Hypothesis = field(default_factory=Hypothesis)
    undone: float = 0.0
    ended_gradually: bool = False


@dataclass(slots=True)
class AttitudeWitness:
    """External rest sensor.

    is_believed
        False from a contradiction by rates or accelerations until the sensor reports another state.
    refuted
        Number of contradictions.
    contradictions
        Blocks that contradict, less a tenth for each that fits.
    blocks
        Blocks in a row that it calls still.
    """

    is_believed: bool = True
    refuted: int = 0
    contradictions: float = 0.0
    blocks: int = 0


UNITS = np.array((GYRO_SPREAD,) * 3 + (ACCEL_SPREAD,) * 3)


def add_block(w: Windows, block: Integrals) -> None:
    """Keep the means of a block; windows do not reach over a change between blocks with and without acceleration."""
    is_blind = not np.isfinite(block.velocity).all()
    if is_blind != w.is_blind:
        w.blocks, w.is_blind = 0, is_blind
    row = np.concatenate((block.gyro, np.zeros(3) if is_blind else block.accel)) / UNITS
    slot = w.total % LONGEST
    w.rows[slot] = w.rows[slot + LONGEST] = row
    w.blocks += 1
    w.total += 1


def find_rest(w: Windows, limits: float, *, is_resting: bool) -> RestCandidate | None:
    """First kind of rest whose window, which ends now, looks still; None without any.

    `limits` is a factor on all limits. Without acceleration only a quiet rest counts.
    """
    if w.blocks < BRIEF.blocks:
        return None
    end = (w.total - 1) % LONGEST + LONGEST + 1
    last = w.rows[end - BRIEF.blocks : end]
    squares = ((last - last.sum(axis=0) / BRIEF.blocks) ** 2).sum(axis=0)
    squares_of_gyro, squares_of_accel = float(squares[:3].max()), float(squares[3:].max())
    for kind in (QUIET,) if w.is_blind else KINDS:
        free = limits * limits * (kind.blocks - 1)
        if (
            w.blocks < kind.blocks
            or (kind is BRIEF and is_resting)
            or squares_of_gyro > free * kind.gyro**2
            or squares_of_accel > free * kind.accel**2
        ):
            continue
        candidate = _still_window(w.rows[end - kind.blocks : end], kind, limits)
        if candidate is not None and (w.is_blind or _is_gravity(candidate)) and not _is_fast(w, candidate):
            return candidate
    return None


def last_window(w: Windows, kind: RestKind, limits: float) -> RestCandidate | None:
    """The window of this kind that ends now, if it looks still."""
    end = (w.total - 1) % LONGEST + LONGEST + 1
    return _still_window(w.rows[end - kind.blocks : end], kind, limits) if w.blocks >= kind.blocks else None


def _still_window(rows: Floats, kind: RestKind, limits: float) -> RestCandidate | None:
    """The window as a candidate if its block means scatter little, and its newer half has the mean of the whole."""
    mean = rows.sum(axis=0) / kind.blocks
    deviations = rows - mean
    variances = (deviations * deviations).sum(axis=0) / (kind.blocks - 1)
    newer = np.abs(deviations[-(kind.blocks // 2) :].sum(axis=0) / (kind.blocks // 2))
    gyro, accel = limits * kind.gyro, limits * kind.accel
    if variances[:3].max() > gyro * gyro or variances[3:].max() > accel * accel:
        return None
    if newer[:3].max() > 0.5 * gyro or newer[3:].max() > 0.5 * accel:
        return None
    return RestCandidate(kind, mean[:3] * GYRO_SPREAD, variances[:3] * GYRO_SPREAD**2, mean[3:] * ACCEL_SPREAD)


def _is_gravity(candidate: RestCandidate) -> bool:
    return abs(float(np.sqrt(candidate.accel @ candidate.accel)) - GRAVITY) < GRAVITY_GATE


def _is_fast(w: Windows, candidate: RestCandidate) -> bool:
    fastest = FASTEST_START if w.total <= BRIEF.blocks + 1 else FASTEST_BRIEF
    return candidate.kind is BRIEF and float(np.abs(candidate.gyro).max()) > fastest
