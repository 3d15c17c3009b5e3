"""Scale and sign from whole turns: what one turn may read, and what many of them say together.

A stop at the mark is never exact. How exactly a person stops shows in the scatter of the turns, which therefore gives
the standard error of the scale, noise and wander of the bias included. All turns of a direction begin and end at stops
of their own, so that their errors are independent of each other.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt
from typing import Literal, NamedTuple

import numpy as np

from gyrodrift.errors import CalibrationError

WHOLE_DEG = 360.0
OFF_MOST = 0.1
OFF_MOST_DEG = 170.0
"""A scale factor is wrong by less than a tenth (data sheets: 3 %), and turns are counted right where they read nearer
to their number than to another one."""

DIFFERS_MOST = 0.03
"""Turns of one direction that differ by more are not of the same number of turns, or do not end at the same mark."""

LEAST = 3
"""Times each direction is turned: fewer tell nothing of how exactly they are."""

SPREAD_MOST = 0.01
"""A scale that is not known to a percent is not worth having: that is what data sheets promise without calibration."""

RADIAN = 57.29578
FACTORS = (2.0, 4.0, 8.0, 16.0)
NEAR = 0.1


class Turns(NamedTuple):
    """A move of whole turns, as measured: the angle in the device's own sign, degrees."""

    is_ccw: bool
    turns: int
    angle_deg: float


@dataclass(frozen=True, slots=True)
class Scales:
    """What all turns say together; `sign`, scales and their standard errors as in a calibration.

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
    """See that a move may be what it is said to be.

    Raises
    ------
    CalibrationError
        Where its angle is far from so many whole turns, or from what the others read, or has their sign.
    """
    whole_deg, read_deg = WHOLE_DEG * new.turns, abs(new.angle_deg)
    off_deg = read_deg - whole_deg
    if abs(off_deg) > min(OFF_MOST * whole_deg, OFF_MOST_DEG):
        raise CalibrationError(f"{_count(new.turns)} read {new.angle_deg:+.1f} deg, {_why_off(read_deg, whole_deg)}")
    for other in before:
        is_same_way = (other.angle_deg > 0.0) == (new.angle_deg > 0.0)
        if is_same_way != (other.is_ccw == new.is_ccw):
            way = "counter-clockwise" if new.is_ccw else "clockwise"
            raise CalibrationError(
                f"{_count(new.turns)} read {new.angle_deg:+.1f} deg, the sign of the other direction: was it {way}?"
            )
    same = [abs(other.angle_deg) for other in before if other.is_ccw == new.is_ccw]
    if same and abs(read_deg / float(np.median(same)) - 1.0) > DIFFERS_MOST:
        raise CalibrationError(
            f"{_count(new.turns)} read {new.angle_deg:+.1f} deg, those before {np.median(same):.1f} deg: did it stop "
            "at the mark?"
        )


def _count(turns: int) -> str:
    return "one turn" if turns == 1 else f"{turns} turns"


def _why_off(read_deg: float, whole_deg: float) -> str:
    """What is probably wrong where an angle is far from the one that was turned."""
    share = read_deg / whole_deg
    counted = round(read_deg / WHOLE_DEG)
    if share < NEAR and abs(share * RADIAN - 1.0) > NEAR:
        return "hardly anything: the axis that is read is not the vertical one, or the device was not turned"
    if abs(share * RADIAN - 1.0) <= NEAR or abs(share / RADIAN - 1.0) <= NEAR:
        return "a factor of 57.3: degrees and radians are mixed up (--columns names the unit)"
    for factor in FACTORS:
        if abs(share * factor - 1.0) <= NEAR or abs(share / factor - 1.0) <= NEAR:
            return (
                f"a factor of {factor:g}: turned too few or too many times, or scaled for another range of the sensor"
            )
    if counted and abs(read_deg - WHOLE_DEG * counted) <= OFF_MOST * WHOLE_DEG:
        return f"nearer to {_count(counted)}: count them again"
    return "which is no whole turn: did it stop at the mark, and does the axis stand upright?"


def scales_of(found: Sequence[Turns]) -> Scales | None:
    """Of all turns; None where a direction was turned less than LEAST times."""
    ccw = np.array([abs(one.angle_deg) for one in found if one.is_ccw])
    cw = np.array([abs(one.angle_deg) for one in found if not one.is_ccw])
    if min(len(ccw), len(cw)) < LEAST:
        return None
    turns = found[0].turns
    squares = float(((ccw - ccw.mean()) ** 2).sum() + ((cw - cw.mean()) ** 2).sum())
    deviation_deg = sqrt(squares / (len(ccw) + len(cw) - 2))
    sign: Literal[1, -1] = 1 if next(one for one in found if one.is_ccw).angle_deg > 0.0 else -1
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


def settled(found: Sequence[Turns]) -> Scales:
    """What is written in the end.

    Raises
    ------
    CalibrationError
        Where there are too few turns, or they differ too much.
    """
    scales = scales_of(found)
    if scales is None:
        counts = [sum(one.is_ccw == is_ccw for one in found) for is_ccw in (True, False)]
        raise CalibrationError(
            f"too few turns: {counts[0]} counter-clockwise and {counts[1]} clockwise; each direction is needed "
            f"{LEAST} times, or nothing says how exact they are"
        )
    if scales.spread > SPREAD_MOST:
        raise CalibrationError(
            f"the turns differ too much: the scale is known to {scales.spread:.1%}, {SPREAD_MOST:.0%} is the most; "
            f"a stop at the mark was {scales.mark_deg:.1f} deg off (standard deviation): turn several turns at a time, "
            "with --turns 5, or make the mark sharper"
        )
    return scales
