"""Scale and sign from whole turns.

A stop at the mark is never exact. The scatter of the turns contains the error of the stops, noise and bias wander, and
gives the standard error of the scale. All turns have stops of their own, so their errors are independent.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt
from typing import Literal, NamedTuple

import numpy as np

from gyrodrift.values.errors import CalibrationError

WHOLE_DEG = 360.0
ERROR_MAX = 0.1
ERROR_MAX_DEG = 170.0
"""Largest error of a turn: a tenth of the angle (data sheets: 3 %), and less than half a turn."""

DIFFERENCE_MAX = 0.03
"""Turns of a direction that differ by more have another number of turns, or do not end at the same mark."""

REPEATS_MIN = 3
"""Repeats per direction: fewer give no useful scatter."""

SPREAD_MAX = 0.01
"""Largest standard error of a scale: data sheets promise about a percent without calibration."""

RADIAN = 57.29578
FACTORS = (2.0, 4.0, 8.0, 16.0)
NEAR = 0.1


class Turns(NamedTuple):
    """Measured move of whole turns: the angle in the sign of the device, degrees."""

    is_ccw: bool
    turns: int
    angle_deg: float


@dataclass(frozen=True, slots=True)
class Scales:
    """Result of all turns; `sign`, scales and standard errors as in a calibration.

    mark_deg
        Standard deviation of a stop at the mark, degrees.
    """

    sign: Literal[1, -1]
    scale_ccw: float
    scale_ccw_se: float
    scale_cw: float
    scale_cw_se: float
    mark_deg: float
    turns: int
    repeats: int

    @property
    def spread(self) -> float:
        """The larger standard error."""
        return max(self.scale_ccw_se, self.scale_cw_se)


def check_turns(new: Turns, before: Sequence[Turns]) -> None:
    """Check that a move is the requested number of turns in the requested direction.

    Raises
    ------
    CalibrationError
        The angle differs too much from whole turns or from earlier turns, or has the sign of the other direction.
    """
    whole_deg, read_deg = WHOLE_DEG * new.turns, abs(new.angle_deg)
    off_deg = read_deg - whole_deg
    if abs(off_deg) > min(ERROR_MAX * whole_deg, ERROR_MAX_DEG):
        raise CalibrationError(f"{_count(new.turns)} read {new.angle_deg:+.1f} deg, {_why_off(read_deg, whole_deg)}")
    for earlier in before:
        is_same_way = (earlier.angle_deg > 0.0) == (new.angle_deg > 0.0)
        if is_same_way != (earlier.is_ccw == new.is_ccw):
            way = "counter-clockwise" if new.is_ccw else "clockwise"
            raise CalibrationError(
                f"{_count(new.turns)} read {new.angle_deg:+.1f} deg, the sign of the other direction: was it {way}?"
            )
    same = [abs(earlier.angle_deg) for earlier in before if earlier.is_ccw == new.is_ccw]
    if same and abs(read_deg / float(np.median(same)) - 1.0) > DIFFERENCE_MAX:
        raise CalibrationError(
            f"{_count(new.turns)} read {new.angle_deg:+.1f} deg, earlier ones {np.median(same):.1f} deg: did it stop "
            "at the mark?"
        )


def _count(turns: int) -> str:
    return "one turn" if turns == 1 else f"{turns} turns"


def _why_off(read_deg: float, whole_deg: float) -> str:
    """Probable cause of a wrong angle."""
    share = read_deg / whole_deg
    counted = round(read_deg / WHOLE_DEG)
    if share < NEAR and abs(share * RADIAN - 1.0) > NEAR:
        return "almost nothing: the measured axis is not vertical, or the device was not turned"
    if abs(share * RADIAN - 1.0) <= NEAR or abs(share / RADIAN - 1.0) <= NEAR:
        return "a factor of 57.3: degrees and radians are mixed up (--columns names the unit)"
    for factor in FACTORS:
        if abs(share * factor - 1.0) <= NEAR or abs(share / factor - 1.0) <= NEAR:
            return f"a factor of {factor:g}: too few or too many turns, or a scale for another range of the sensor"
    if counted and abs(read_deg - WHOLE_DEG * counted) <= ERROR_MAX * WHOLE_DEG:
        return f"nearer to {_count(counted)}: count them again"
    return "not a whole turn: did it stop at the mark, and is the axis vertical?"


def scales_of(moves: Sequence[Turns]) -> Scales | None:
    """Scales from all moves; None with fewer than REPEATS_MIN in a direction."""
    ccw = np.array([abs(move.angle_deg) for move in moves if move.is_ccw])
    cw = np.array([abs(move.angle_deg) for move in moves if not move.is_ccw])
    if min(len(ccw), len(cw)) < REPEATS_MIN:
        return None
    turns = moves[0].turns
    squares = float(((ccw - ccw.mean()) ** 2).sum() + ((cw - cw.mean()) ** 2).sum())
    deviation_deg = sqrt(squares / (len(ccw) + len(cw) - 2))
    sign: Literal[1, -1] = 1 if next(move for move in moves if move.is_ccw).angle_deg > 0.0 else -1
    scale_ccw, scale_cw = (WHOLE_DEG * turns / float(angles.mean()) for angles in (ccw, cw))
    return Scales(
        sign=sign,
        scale_ccw=scale_ccw,
        scale_ccw_se=scale_ccw * deviation_deg / float(ccw.mean()) / sqrt(len(ccw)),
        scale_cw=scale_cw,
        scale_cw_se=scale_cw * deviation_deg / float(cw.mean()) / sqrt(len(cw)),
        mark_deg=deviation_deg / sqrt(2.0),
        turns=turns,
        repeats=min(len(ccw), len(cw)),
    )


def checked_scales(moves: Sequence[Turns]) -> Scales:
    """Scales that are good enough for a config.

    Raises
    ------
    CalibrationError
        There are too few turns, or they differ too much.
    """
    scales = scales_of(moves)
    if scales is None:
        counts = [sum(move.is_ccw == is_ccw for move in moves) for is_ccw in (True, False)]
        raise CalibrationError(
            f"too few turns: {counts[0]} counter-clockwise and {counts[1]} clockwise; turn each direction "
            f"{REPEATS_MIN} times, to give a standard error"
        )
    if scales.spread > SPREAD_MAX:
        raise CalibrationError(
            f"the turns differ too much: the standard error of the scale is {scales.spread:.1%}, above "
            f"{SPREAD_MAX:.0%}; a stop at the mark had a standard deviation of {scales.mark_deg:.1f} deg: turn several "
            "turns at a time with --turns 5, or use a finer mark"
        )
    return scales
