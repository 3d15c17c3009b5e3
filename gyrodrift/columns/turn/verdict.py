"""Column that shows a quarter turn to the left, with unit and sign, or the reason why none does."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import degrees

import numpy as np

from gyrodrift.columns.sizes import gravity_unit
from gyrodrift.columns.turn.motion import Behavior, ColumnMotion, TurnWindow, motion_of, unwrapped
from gyrodrift.columns.turn.scale import (
    ANGLE_TOLERANCE,
    HAND,
    QUARTER_DEG,
    STATED_WITHIN,
    Scale,
    scale_of,
    stated_scale,
)
from gyrodrift.columns.turn.series import Series
from gyrodrift.columns.units import Dimension
from gyrodrift.values.arrays import Floats

SIMILAR_SHARE = 0.35
"""Share of the clearest motion from which another column is a further axis that turns, too."""

COPY = 0.99
"""Correlation of two columns that print the same quantity."""

AS_NOISY = 3.0
"""Largest ratio of noises that count as equal: two axes of a sensor, measured in a short rest."""

AS_ANGLE = 0.98
"""Correlation of an angle with the integral of its rate."""

NORM = 0.05
"""Largest relative error of the length of three accelerations (gravity) or of a quaternion (1) at rest."""


def turns_as(rate: ColumnMotion, angle: ColumnMotion) -> bool:
    """Whether the angle is proportional to the integral of the rate."""
    if rate.t_s is None or rate.deviation is None or angle.t_s is None or angle.deviation is None:
        return False
    steps = 0.5 * (rate.deviation[1:] + rate.deviation[:-1]) * np.diff(rate.t_s)
    summed = np.concatenate([[0.0], np.cumsum(steps)])
    return abs(_correlation(rate.t_s, summed, angle.t_s, angle.deviation)) > AS_ANGLE


def share(motion: ColumnMotion, clearest: ColumnMotion) -> float:
    """Clearness of a motion relative to the clearest one; with equal noise, the ratio of their sizes."""
    if 1.0 / AS_NOISY < motion.noise / clearest.noise < AS_NOISY:
        return motion.clearness * motion.noise / (clearest.clearness * clearest.noise)
    return motion.clearness / clearest.clearness


def is_copy(first: ColumnMotion, second: ColumnMotion) -> bool:
    """Whether both columns print the same quantity: by their labels, or in two units that exist."""
    if first.t_s is None or second.t_s is None or first.deviation is None or second.deviation is None:
        return False
    if abs(_correlation(first.t_s, first.deviation, second.t_s, second.deviation)) < COPY or not second.integral:
        return False
    ratio = abs(first.integral / second.integral)
    if 1.0 / SIMILAR_SHARE > ratio > SIMILAR_SHARE:  # two axes of a tilted device, unless both labels say rate
        return first.series.kind == second.series.kind == "rate" and abs(ratio - 1.0) < ANGLE_TOLERANCE
    return all(scale_of(motion.integral, QUARTER_DEG, HAND) is not None for motion in (first, second))


def _correlation(t_s: Floats, values: Floats, second_t_s: Floats, second: Floats) -> float:
    matched = np.interp(t_s, second_t_s, second)
    spreads = float(np.std(values)) * float(np.std(matched))
    return float(np.mean((values - values.mean()) * (matched - matched.mean()))) / spreads if spreads > 0.0 else 0.0


def of_gravity(motions: Sequence[ColumnMotion]) -> list[ColumnMotion]:
    """Three adjacent columns whose length at rest is gravity; empty without."""
    for three in zip(motions, motions[1:], motions[2:], strict=False):
        length = float(np.linalg.norm([motion.level for motion in three]))
        if _are_adjacent(three) and gravity_unit(length, NORM):
            return list(three)
    return []


def of_unit_length(motions: Sequence[ColumnMotion]) -> list[ColumnMotion]:
    """Four adjacent columns whose length is 1 before and after the turn (a quaternion); empty without."""
    for four in zip(motions, motions[1:], motions[2:], motions[3:], strict=False):
        lengths = [
            float(np.linalg.norm([motion.level + share * motion.change for motion in four])) for share in (0.0, 1.0)
        ]
        if _are_adjacent(four) and all(abs(length - 1.0) < NORM for length in lengths):
            return list(four)
    return []


def _are_adjacent(motions: Sequence[ColumnMotion]) -> bool:
    return all(b.series.key.index == a.series.key.index + 1 or a.series.key.label for a, b in pairwise(motions))


SLOW_HZ = 4.0
"""Values a second below which a quarter turn by hand, 1 to 2 s, has too few to be told from damage."""

REACHED = 0.03
"""Distance from its new level at which an angle has arrived, as a share of its change."""

ANGLES = (("deg", 1.0, 360.0), ("rad", degrees(1.0), 2.0 * np.pi))
RATE_KINDS = frozenset({"rate", "rates", "gx", "gy"})
FIRST_NAMED = ("yaw", "heading", "angle", "")


@dataclass(frozen=True, slots=True)
class AngleColumn:
    """Column that holds the angle; `motion` is without jumps at the ends of the range, `turn_deg` as printed."""

    motion: ColumnMotion
    unit: str
    turn_deg: float

    @property
    def reached_s(self) -> float:
        """Time at which the angle arrived at its new level, s."""
        motion = self.motion
        if motion.t_s is None or motion.deviation is None:
            return motion.last_s
        on_its_way = np.abs(motion.deviation - motion.change) > REACHED * abs(motion.change)
        return float(motion.t_s[on_its_way][-1]) if on_its_way.any() else motion.last_s


@dataclass(frozen=True, slots=True)
class RateColumn:
    """Column that holds the rate; `turn_deg` is the turn in the unit of `scale`."""

    motion: ColumnMotion
    scale: Scale
    turn_deg: float
    is_stated: bool = False


@dataclass(frozen=True, slots=True)
class TurnVerdict:
    """Result of a turn.

    rate, angle
        Columns of the rate and of the angle; the rate is used if both exist.
    question
        Reason why neither exists, and what to do; empty otherwise.
    remarks
        Contradictions to labels, as sentences.
    motions
        Motions of all columns.
    """

    rate: RateColumn | None
    angle: AngleColumn | None
    question: str
    remarks: tuple[str, ...]
    motions: tuple[ColumnMotion, ...]

    @property
    def column(self) -> RateColumn | AngleColumn | None:
        """Column that gives yaw."""
        return self.rate or self.angle


@np.errstate(all="ignore")  # a text may hold numbers of any size
def judge(series: Sequence[Series], window: TurnWindow) -> TurnVerdict:
    """Judge the columns of a text by a quarter turn to the left between two rests."""
    motions = tuple(motion_of(column, window) for column in series)
    angle, why_no_angle = _angle(motions, window)
    rate, why_no_rate = _rate(motions, angle)
    remarks = tuple(_remarks(rate))
    question = "" if rate or angle else why_no_rate or why_no_angle or _question(motions)
    return TurnVerdict(rate, angle, question, remarks, motions)


def _rate(motions: Sequence[ColumnMotion], angle: AngleColumn | None) -> tuple[RateColumn | None, str]:
    returning = {Behavior.RATE, Behavior.RETURNS}
    moving = [motion for motion in motions if motion.behavior in returning and motion.series.can_turn]
    rates = [motion for motion in moving if motion.behavior is Behavior.RATE]
    if not rates:
        return None, ""
    clearest = max(rates, key=lambda motion: motion.clearness)
    accelerations = of_gravity(motions) if clearest not in of_gravity(motions) else []
    similar = [
        motion
        for motion in moving
        if motion is not clearest
        and motion not in accelerations
        and share(motion, clearest) >= SIMILAR_SHARE
        and not is_copy(motion, clearest)
    ]
    if similar:
        names = ", ".join(motion.series.name for motion in [clearest, *similar])
        return None, (
            f"{names} all turned, so none of them is the vertical axis; lay the device level, and turn it again about"
            " the vertical axis only"
        )
    if angle is not None and not turns_as(clearest, angle.motion):
        return None, f"{clearest.series.name} moved, but not like the angle {angle.motion.series.name}"
    copies = [
        motion
        for motion in rates
        if motion is clearest or (share(motion, clearest) >= SIMILAR_SHARE and is_copy(motion, clearest))
    ]
    candidates = [rate for motion in copies if (rate := _scaled(motion, angle)) is not None]
    if candidates:
        return min(candidates, key=lambda rate: (not rate.scale.is_known, -rate.motion.clearness)), ""
    return None, (
        f"{clearest.series.name} moved like a rate, by {abs(clearest.integral):.3g} of its units in all, which is a"
        " quarter turn in no known unit; turn it again by exactly a quarter turn, with the device level"
    )


def _scaled(motion: ColumnMotion, angle: AngleColumn | None) -> RateColumn | None:
    turn_deg, within = (abs(angle.turn_deg), ANGLE_TOLERANCE) if angle else (QUARTER_DEG, HAND)
    stated = stated_scale(motion.series.unit, motion.integral, turn_deg)
    is_named = motion.series.kind == "rate"
    scale = (
        stated
        or scale_of(motion.integral, turn_deg, within)
        or scale_of(motion.integral, QUARTER_DEG, HAND, is_named=is_named)
    )
    if scale is None:
        return None
    per_dps = scale.near[0].per_dps if scale.is_known else scale.per_dps
    return RateColumn(motion, scale, motion.integral / per_dps, stated is not None)


def _angle(motions: Sequence[ColumnMotion], window: TurnWindow) -> tuple[AngleColumn | None, str]:
    quaternions = of_unit_length(motions)
    angles = [
        angle
        for motion in motions
        if motion.series.can_turn
        and motion.series.kind not in RATE_KINDS
        and motion not in quaternions
        and (angle := _as_angle(motion, window)) is not None
    ]
    if not angles:
        return None, ""
    first = min(angles, key=_name_rank)
    similar = [
        motion
        for motion in motions
        if motion.behavior in {Behavior.STAYS, Behavior.RESTLESS}
        and motion.series.can_turn
        and motion.series is not first.motion.series
        and share(motion, first.motion) >= SIMILAR_SHARE
        and not any(angle.motion.series is motion.series and _is_same_turn(angle, first) for angle in angles)
    ]
    if similar and not first.motion.series.kind:
        names = ", ".join(motion.series.name for motion in similar)
        return None, f"{first.motion.series.name} changed by a quarter turn, but {names} changed with it"
    return first, ""


def _name_rank(angle: AngleColumn) -> int:
    kind = angle.motion.series.kind
    return FIRST_NAMED.index(kind) if kind in FIRST_NAMED else len(FIRST_NAMED)


def _as_angle(motion: ColumnMotion, window: TurnWindow) -> AngleColumn | None:
    """Column as an angle in degrees or radians; None if it did not change by a quarter turn."""
    for unit, factor, period in ANGLES:
        stated = motion.series.unit
        if stated is not None and (stated.dimension is Dimension.RATE or stated.option not in {"", unit}):
            continue
        if np.abs(motion.series.values).max(initial=0.0) > 1.01 * period:
            continue
        smooth = motion_of(motion.series, window, unwrapped(motion.series.values, period))
        turn_deg = smooth.change * factor
        if smooth.behavior is Behavior.STAYS and 1.0 / (1.0 + HAND) < abs(turn_deg) / QUARTER_DEG < 1.0 + HAND:
            return AngleColumn(smooth, unit, turn_deg)
    return None


def _is_same_turn(first: AngleColumn, second: AngleColumn) -> bool:
    return abs(abs(first.turn_deg) - abs(second.turn_deg)) < ANGLE_TOLERANCE * QUARTER_DEG


def _remarks(rate: RateColumn | None) -> list[str]:
    if rate is None:
        return []
    series, remarks = rate.motion.series, []
    unit = series.unit
    if unit is not None and unit.dimension is Dimension.RATE and not rate.is_stated:
        remarks.append(f"its label says {unit.option}, but the turn differs from that by more than {STATED_WITHIN:.0%}")
    return remarks


def _question(motions: Sequence[ColumnMotion]) -> str:
    moved = [motion for motion in motions if motion.behavior not in {Behavior.QUIET, Behavior.GROWS}]
    if not moved:
        return "no column moved; hold the device still, and turn all of it by a quarter turn after the prompt"
    if all(motion.behavior is Behavior.RESTLESS for motion in moved):
        return "the device did not come to rest; turn it by a quarter turn, then hold it still until the end"
    if quaternion := of_unit_length(motions):
        names = ", ".join(motion.series.name for motion in quaternion)
        return f"{names} are a quaternion, which --columns cannot read; print the yaw rate or yaw, too"
    pace_hz = max(len(motion.series.values) / max(float(np.ptp(motion.series.t_s)), 1.0) for motion in moved)
    if pace_hz < SLOW_HZ:
        return f"only {pace_hz:.2g} values arrive a second; turn it slowly, over 5 s or more, then hold it still"
    names = ", ".join(f"{motion.series.name} {motion.behavior}" for motion in moved[:6])
    return f"no column shows a quarter turn: {names}; turn it again by exactly a quarter turn, with the device level"
