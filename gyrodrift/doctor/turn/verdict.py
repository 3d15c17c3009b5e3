"""Which column turned in a quarter turn to the left: its unit and sign, or what keeps it from being told."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import degrees

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.columns.units import Dimension
from gyrodrift.doctor.turn.motion import Behaviour, ColumnMotion, TurnWindow, motion_of, unwrapped
from gyrodrift.doctor.turn.scale import BESIDE_ANGLE, HAND, QUARTER_DEG, STATED_WITHIN, Scale, scale_of, stated_scale
from gyrodrift.doctor.turn.series import Series
from gyrodrift.link.text.behaviour import GRAVITIES

RIVAL = 0.35
"""A column that moves as clearly as this share of the clearest one, in another way, is another axis that turns too."""

COPY = 0.99
"""Correlation of two columns that print the same quantity."""

AS_NOISY = 3.0
"""The noise of a short rest is known to no better: two axes of a sensor have the same."""

AS_ANGLE = 0.98
NORM = 0.05
"""Relative: how near to gravity, or to 1, the length of three accelerations, or of a quaternion, is at rest."""

ANGLES = (("deg", 1.0, 360.0), ("rad", degrees(1.0), 2.0 * np.pi))
FIRST_NAMED = ("yaw", "heading", "angle", "")


@dataclass(frozen=True, slots=True)
class TurnedAngle:
    """A column that holds the angle itself; `motion` is without its jumps, `turned_deg` as the column says."""

    motion: ColumnMotion
    unit: str
    turned_deg: float


@dataclass(frozen=True, slots=True)
class TurnedRate:
    """A column that holds the rate; `turned_deg` is the turn by the unit that is told."""

    motion: ColumnMotion
    scale: Scale
    turned_deg: float
    is_stated: bool = False
    by_angle: bool = False


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
    accelerations = _of_gravity(motions) if clearest not in _of_gravity(motions) else []
    rivals = [
        each
        for each in moving
        if each is not clearest
        and each not in accelerations
        and _share(each, clearest) >= RIVAL
        and not _is_copy(each, clearest)
    ]
    if rivals:
        names = ", ".join(each.series.name for each in [clearest, *rivals])
        return None, (
            f"{names} all turned, so the vertical axis is none of them alone; lay the device level, turn it about the"
            " vertical alone, and do it again"
        )
    if angle is not None and not _turns_as(clearest, angle):
        return None, f"{clearest.series.name} moved, but not as {angle.motion.series.name} turned"
    copies = [
        each for each in rates if each is clearest or (_share(each, clearest) >= RIVAL and _is_copy(each, clearest))
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
    return TurnedRate(motion, scale, motion.integral / per_dps, stated is not None, angle is not None)


def _angle(motions: Sequence[ColumnMotion], window: TurnWindow) -> tuple[TurnedAngle | None, str]:
    quaternions = _of_unit_length(motions)
    found = [
        angle
        for motion in motions
        if motion.series.can_turn and motion not in quaternions and (angle := _as_angle(motion, window)) is not None
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
        and _share(each, first.motion) >= RIVAL
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
        if stated is not None and stated.dimension is Dimension.ANGLE and stated.option != unit:
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


def _turns_as(rate: ColumnMotion, angle: TurnedAngle) -> bool:
    """Whether the angle is what the rate adds up to, at any scale."""
    if rate.t_s is None or rate.deviation is None or angle.motion.t_s is None or angle.motion.deviation is None:
        return False
    steps = 0.5 * (rate.deviation[1:] + rate.deviation[:-1]) * np.diff(rate.t_s)
    summed = np.concatenate([[0.0], np.cumsum(steps)])
    return abs(_correlation(rate.t_s, summed, angle.motion.t_s, angle.motion.deviation)) > AS_ANGLE


def _share(motion: ColumnMotion, clearest: ColumnMotion) -> float:
    """How clearly a column moved beside another: by the noise, or by size where it is nearly the same."""
    if 1.0 / AS_NOISY < motion.noise / clearest.noise < AS_NOISY:
        return motion.clearness * motion.noise / (clearest.clearness * clearest.noise)
    return motion.clearness / clearest.clearness


def _is_copy(one: ColumnMotion, other: ColumnMotion) -> bool:
    """Whether both print one quantity: by their labels, or in two units that exist."""
    if one.t_s is None or other.t_s is None or one.deviation is None or other.deviation is None:
        return False
    if abs(_correlation(one.t_s, one.deviation, other.t_s, other.deviation)) < COPY or not other.integral:
        return False
    ratio = abs(one.integral / other.integral)
    if 1.0 / RIVAL > ratio > RIVAL:  # of one size: two axes of a device that is tilted, unless both are called the rate
        return one.series.kind == other.series.kind == "rate" and abs(ratio - 1.0) < BESIDE_ANGLE
    return all(scale_of(each.integral, QUARTER_DEG, HAND) is not None for each in (one, other))


def _correlation(t_s: Floats, values: Floats, other_t_s: Floats, others: Floats) -> float:
    matched = np.interp(t_s, other_t_s, others)
    spreads = float(np.std(values)) * float(np.std(matched))
    return float(np.mean((values - values.mean()) * (matched - matched.mean()))) / spreads if spreads > 0.0 else 0.0


def _of_gravity(motions: Sequence[ColumnMotion]) -> list[ColumnMotion]:
    """Three columns beside each other whose length at rest is that of gravity."""
    for three in zip(motions, motions[1:], motions[2:], strict=False):
        length = float(np.linalg.norm([each.level for each in three]))
        if _are_beside(three) and any(abs(length - known) <= NORM * known for known in GRAVITIES):
            return list(three)
    return []


def _of_unit_length(motions: Sequence[ColumnMotion]) -> list[ColumnMotion]:
    """Four columns beside each other whose length is 1 before and after the turn: a quaternion."""
    for four in zip(motions, motions[1:], motions[2:], motions[3:], strict=False):
        lengths = [float(np.linalg.norm([each.level + share * each.change for each in four])) for share in (0.0, 1.0)]
        if _are_beside(four) and all(abs(length - 1.0) < NORM for length in lengths):
            return list(four)
    return []


def _are_beside(motions: Sequence[ColumnMotion]) -> bool:
    return all(b.series.key.place == a.series.key.place + 1 or a.series.key.label for a, b in pairwise(motions))


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
    if quaternion := _of_unit_length(motions):
        names = ", ".join(each.series.name for each in quaternion)
        return f"{names} are a quaternion, from which no column can be read; print the yaw rate beside it, or yaw"
    names = ", ".join(f"{each.series.name} {each.behaviour}" for each in moved[:6])
    return f"no column turned by a quarter turn: {names}; do it again, exactly a quarter turn, the device lying level"
