"""A measurement of a second source beside the gyro: standing, heading, turn rate, wheels or speed."""

from math import nan
from typing import Literal, NamedTuple, get_args

AidKind = Literal["standing", "heading", "turn_rate", "wheels", "speed"]
"""Kinds of measurements of a second source."""

AID_KINDS: tuple[AidKind, ...] = get_args(AidKind)


class Aid(NamedTuple):
    """One measurement of a second source. It is evidence, and may be late, wrong now and then, or stop.

    name
        Name of the source; measurements of one name share their unknown offset, scale and trust.
    kind
        Meaning of `value`.
    value
        standing
            1 at rest, 0 in motion.
        heading
            Angle about the vertical, deg, counter-clockwise positive. Its zero may be another than that of yaw.
        turn_rate
            Rate about the vertical, deg/s, counter-clockwise positive.
        wheels
            Speed of the right wheel minus that of the left wheel, in any unit: the track is unknown, too.
        speed
            Speed of the device, m/s.
    t_s
        Time of the measurement on the clock of the samples, s; NaN for the time of the last sample.
    sigma
        Standard deviation in the unit of the value; NaN for that of the kind.
    period_deg
        Of a heading: 360, or 90 for one of the four directions of a building.
    speed
        Of wheels: mean of both, in their unit; of a heading that is a course: speed, m/s. NaN if unknown.
    """

    name: str
    kind: AidKind
    value: float
    t_s: float = nan
    sigma: float = nan
    period_deg: float = 360.0
    speed: float = nan


class AidStatus(NamedTuple):
    """How a second source and the filter agree.

    age_s
        Time since its last measurement, on the clock of the samples, s.
    weight
        Share of its last measurements that agree, 0 to 1.
    differs
        How it contradicts the filter, in words with figures; empty while it is used.
    """

    age_s: float
    weight: float
    differs: str = ""
