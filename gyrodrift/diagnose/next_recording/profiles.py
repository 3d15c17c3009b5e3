"""Manoeuvres put together to a profile, and the file that it is played from."""

from collections.abc import Sequence

import yaml

from firmware_sim.motion.profile import Ambient, Profile, Segment
from firmware_sim.motion.segments import Rest
from gyrodrift.diagnose.next_recording.manoeuvres import Manoeuvre, MotionLimits

STILL_S = 5.0
"""Each profile begins at power-on with so much rest."""

LEAST_MINUTES = 1.0
"""In less nothing slow shows."""

ROOM_C, WARMER_C, WARMS_C_PER_S = 25.0, 12.0, 10.0 / 60.0
"""Air warms by no more than this, and no quicker than a hair dryer or a box with a lamp does it."""


def profile_of(manoeuvres: Sequence[Manoeuvre], minutes: float, limits: MotionLimits) -> Profile:
    """A profile in which each manoeuvre gets the same share of the time.

    Raises
    ------
    ValueError
        Where it would be shorter than LEAST_MINUTES.
    """
    if minutes < LEAST_MINUTES:
        raise ValueError(f"a recording of {minutes:g} min is too short; it takes {LEAST_MINUTES:g} min")
    seconds = (60.0 * minutes - STILL_S) / len(manoeuvres)
    segments: list[Segment] = [Rest(kind="rest", seconds=STILL_S)]
    ambient = [Ambient(at_s=0.0, temp_c=ROOM_C)]
    for number, one in enumerate(manoeuvres):
        segments += one.segments(seconds, limits)
        if one.warms_air:
            ambient += _warm(STILL_S + number * seconds, seconds)
    words = ", then ".join(one.says(limits) for one in manoeuvres)
    about = f"{minutes:g} min from power-on: {words}."
    return Profile(about=about, segments=tuple(segments), ambient=tuple(ambient))


def warmer_c(seconds: float) -> float:
    """By how much the air warms in a manoeuvre of a length, °C."""
    return min(WARMER_C, WARMS_C_PER_S * 0.5 * seconds)


def profile_yaml(profile: Profile) -> str:
    """The profile as a file that `simulate --profile` and `firmware_sim` take."""
    # JSON's plain lists: the same tuple in two places would be written as an alias, which no profile may hold.
    text: str = yaml.safe_dump(profile.model_dump(mode="json"), sort_keys=False, width=100)
    return text


def _warm(start_s: float, seconds: float) -> list[Ambient]:
    """Up until the middle of it, and down again; nothing where it begins, if something ended there."""
    peak_c = ROOM_C + warmer_c(seconds)
    points = [(0.0, ROOM_C), (0.5 * seconds, peak_c), (0.98 * seconds, ROOM_C)]
    return [Ambient(at_s=start_s + at_s, temp_c=temp_c) for at_s, temp_c in points]
