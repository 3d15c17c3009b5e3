"""Which column turned in a quarter turn to the left: its unit and sign, or what keeps it from being told."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import degrees

import numpy as np

from gyrodrift.columns.units import Dimension
from gyrodrift.doctor.turn.motion import Behaviour, ColumnMotion, TurnWindow, motion_of, unwrapped
from gyrodrift.doctor.turn.relations import RIVAL, is_copy, of_gravity, of_unit_length, share, turns_as
from gyrodrift.doctor.turn.scale import BESIDE_ANGLE, HAND, QUARTER_DEG, STATED_WITHIN, Scale, scale_of, stated_scale
from gyrodrift.doctor.turn.series import Series

REACHED = 0.03
"""Of its change: an angle is there from here on."""

ANGLES = (("deg", 1.0, 360.0), ("rad", degrees(1.0), 2.0 * np.pi))
RATE_KINDS = frozenset({"rate", "rates", "gx", "gy"})
FIRST_NAMED = ("yaw", "heading", "angle", "")


@dataclass(frozen=True, slots=True)
class TurnedAngle:
    """A column that holds the angle itself; `motion` is without its jumps, `turned_deg` as the column says."""

    motion: ColumnMotion
    unit: str
    turned_deg: float

    @property
    def reached_s(self) -> float:
        """When it came to its new level."""
        motion = self.motion
        if motion.t_s is None or motion.deviation is None:
            return motion.last_s
        on_its_way = np.abs(motion.deviation - motion.change) > REACHED * abs(motion.change)
        return float(motion.t_s[on_its_way][-1]) if on_its_way.any() else motion.last_s


@dataclass(frozen=True, slots=True)
class TurnedRate:
    """A column that holds the rate; `turned_deg` is the turn by the unit that is told."""

    motion: ColumnMotion
    scale: Scale
    turned_deg: float
    is_stated: bool = False


@dataclass(frozen=True, slots=True)
class TurnVerdict:
    """What the turn says.

    rate, angle
        The columns that turned; the rate is used where there are both.
    question
        Why neither is told, as a sentence and what to do; empty where one is.
    remarks
        What contradicts a label, sentence by sentence.
    motions
        All columns, for who wants to look.
    """

    rate: TurnedRate | None
    angle: TurnedAngle | None
    question: str
    remarks: tuple[str, ...]
    motions: tuple[ColumnMotion, ...]

    @property
    def turned(self) -> TurnedRate | TurnedAngle | None:
        """The column to read yaw by."""
        return self.rate or self.angle


@np.errstate(all="ignore")  # a text may hold numbers of any size
def judged(series: Sequence[Series], window: TurnWindow) -> TurnVerdict:
    """What a quarter turn to the left between two rests says of the columns of a text."""
    motions = tuple(motion_of(each, window) for each in series)
    angle, why_no_angle = _angle(motions, window)
    rate, why_no_rate = _rate(motions, angle)
    remarks = tuple(_remarks(rate))
    question = "" if rate or angle else why_no_rate or why_no_angle or _question(motions)
    return TurnVerdict(rate, angle, question, remarks, motions)


def _rate(motions: Sequence[ColumnMotion], angle: TurnedAngle | None) -> tuple[TurnedRate | None, str]:
    moving = [
        each for each in motions if each.behaviour in {Behaviour.RATE, Behaviour.RETURNS} and each.series.can_turn
    ]
    rates = [each for each in moving if each.behaviour is Behaviour.RATE]
    if not rates:
        return None, ""
    clearest = max(rates, key=lambda each: each.clearness)
    accelerations = of_gravity(motions) if clearest not in of_gravity(motions) else []
    rivals = [
        each
        for each in moving
        if each is not clearest
        and each not in accelerations
        and share(each, clearest) >= RIVAL
        and not is_copy(each, clearest)
    ]
    if rivals:
        names = ", ".join(each.series.name for each in [clearest, *rivals])
        return None, (
            f"{names} all turned, so the vertical axis is none of them alone; lay the device level, turn it about the"
            " vertical alone, and do it again"
        )
    if angle is not None and not turns_as(clearest, angle.motion):
        return None, f"{clearest.series.name} moved, but not as {angle.motion.series.name} turned"
    copies = [
        each for each in rates if each is clearest or (share(each, clearest) >= RIVAL and is_copy(each, clearest))
    ]
    told = [found for each in copies if (found := _scaled(each, angle)) is not None]
    if told:
        return min(told, key=lambda each: (not each.scale.is_known, -each.motion.clearness)), ""
    return None, (
        f"{clearest.series.name} moved as a rate does, by {abs(clearest.integral):.3g} of its units in all, and a"
        " quarter turn is that in no known unit; do it again, exactly a quarter turn, the device lying level"
    )


def _scaled(motion: ColumnMotion, angle: TurnedAngle | None) -> TurnedRate | None:
    turned_deg, within = (abs(angle.turned_deg), BESIDE_ANGLE) if angle else (QUARTER_DEG, HAND)
    stated = stated_scale(motion.series.unit, motion.integral, turned_deg)
    scale = stated or scale_of(motion.integral, turned_deg, within) or scale_of(motion.integral, QUARTER_DEG, HAND)
    if scale is None:
        return None
    per_dps = scale.near[0].per_dps if scale.is_known else scale.per_dps
    return TurnedRate(motion, scale, motion.integral / per_dps, stated is not None)


def _angle(motions: Sequence[ColumnMotion], window: TurnWindow) -> tuple[TurnedAngle | None, str]:
    quaternions = of_unit_length(motions)
    found = [
        angle
        for motion in motions
        if motion.series.can_turn
        and motion.series.kind not in RATE_KINDS
        and motion not in quaternions
        and (angle := _as_angle(motion, window)) is not None
    ]
    if not found:
        return None, ""
    found.sort(
        key=lambda each: FIRST_NAMED.index(each.motion.series.kind) if each.motion.series.kind in FIRST_NAMED else 9
    )
    first = found[0]
    rivals = [
        each
        for each in motions
        if each.behaviour in {Behaviour.STAYS, Behaviour.RESTLESS}
        and each.series.can_turn
        and each.series is not first.motion.series
        and share(each, first.motion) >= RIVAL
        and not any(other.motion.series is each.series and _is_same_turn(other, first) for other in found)
    ]
    if rivals and not first.motion.series.kind:
        names = ", ".join(each.series.name for each in rivals)
        return None, f"{first.motion.series.name} changed by a quarter turn, but {names} changed with it"
    return first, ""


def _as_angle(motion: ColumnMotion, window: TurnWindow) -> TurnedAngle | None:
    """The column as an angle in degrees or radians; None where it did not change by a quarter turn."""
    for unit, factor, period in ANGLES:
        stated = motion.series.unit
        if stated is not None and (stated.dimension is Dimension.RATE or stated.option not in {"", unit}):
            continue
        if np.abs(motion.series.values).max(initial=0.0) > 1.01 * period:
            continue
        smooth = motion_of(motion.series, window, unwrapped(motion.series.values, period))
        turned_deg = smooth.change * factor
        if smooth.behaviour is Behaviour.STAYS and 1.0 / (1.0 + HAND) < abs(turned_deg) / QUARTER_DEG < 1.0 + HAND:
            return TurnedAngle(smooth, unit, turned_deg)
    return None


def _is_same_turn(other: TurnedAngle, first: TurnedAngle) -> bool:
    return abs(abs(other.turned_deg) - abs(first.turned_deg)) < BESIDE_ANGLE * QUARTER_DEG


def _remarks(rate: TurnedRate | None) -> list[str]:
    if rate is None:
        return []
    series, remarks = rate.motion.series, []
    unit = series.unit
    if unit is not None and unit.dimension is Dimension.RATE and not rate.is_stated:
        remarks.append(f"its label says {unit.option}, and the turn stands against it by more than {STATED_WITHIN:.0%}")
    return remarks


def _question(motions: Sequence[ColumnMotion]) -> str:
    moved = [each for each in motions if each.behaviour not in {Behaviour.QUIET, Behaviour.GROWS}]
    if not moved:
        return "no column moved; turn the whole device by a quarter turn after the prompt, and hold it still before"
    if all(each.behaviour is Behaviour.RESTLESS for each in moved):
        return "the device did not come to rest; turn it by a quarter turn, then let it stand until the end"
    if quaternion := of_unit_length(motions):
        names = ", ".join(each.series.name for each in quaternion)
        return f"{names} are a quaternion, from which no column can be read; print the yaw rate beside it, or yaw"
    names = ", ".join(f"{each.series.name} {each.behaviour}" for each in moved[:6])
    return f"no column turned by a quarter turn: {names}; do it again, exactly a quarter turn, the device lying level"
