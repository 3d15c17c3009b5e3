"""Profiles made of maneuvers, and their files."""

from collections.abc import Sequence

import yaml

from firmware_sim.motion.profile import Ambient, Profile, Segment
from firmware_sim.motion.segments import Rest
from gyrodrift.diagnose.next_recording.maneuvers import Maneuver, MotionLimits

STILL_S = 5.0
"""Rest after power-on, with which each profile begins. Chosen: several blocks of a second show the bias."""

LEAST_MINUTES = 1.0
"""Least length of a recording. Chosen: slow effects need as long to show."""

AIR_C, WARMER_C, WARMS_C_PER_S = 25.0, 12.0, 10.0 / 60.0
"""Temperature of the air, the most that it warms, and its slope. Chosen: a hair dryer or a box with a lamp warms as
quickly."""


def profile_of(maneuvers: Sequence[Maneuver], minutes: float, limits: MotionLimits) -> Profile:
    """Profile in which each maneuver takes the same share of the time.

    Raises
    ------
    ValueError
        If it would be shorter than LEAST_MINUTES.
    """
    if minutes < LEAST_MINUTES:
        raise ValueError(f"a recording of {minutes:g} min is too short; it takes {LEAST_MINUTES:g} min")
    seconds = (60.0 * minutes - STILL_S) / len(maneuvers)
    segments: list[Segment] = [Rest(kind="rest", seconds=STILL_S)]
    ambient = [Ambient(at_s=0.0, temp_c=AIR_C)]
    for index, maneuver in enumerate(maneuvers):
        segments += maneuver.segments(seconds, limits)
        if maneuver.warms_air:
            ambient += _warm(STILL_S + index * seconds, seconds)
    words = ", then ".join(maneuver.says(limits) for maneuver in maneuvers)
    about = f"{minutes:g} min from power-on: {words}."
    return Profile(about=about, segments=tuple(segments), ambient=tuple(ambient))


def warmer_c(seconds: float) -> float:
    """Rise of the air temperature in a maneuver of a given length, °C."""
    return min(WARMER_C, WARMS_C_PER_S * 0.5 * seconds)


def profile_yaml(profile: Profile) -> str:
    """Text of a file for `simulate --profile` and `firmware_sim`."""
    # JSON has plain lists. YAML would write a tuple that is used twice as an alias, which profiles must not have.
    text: str = yaml.safe_dump(profile.model_dump(mode="json"), sort_keys=False, width=100)
    return text


def _warm(start_s: float, seconds: float) -> list[Ambient]:
    """Temperatures of the air that rise until the middle of a maneuver and fall until its end.

    The fall ends a little earlier, at 0.98 of the time: then the next maneuver can begin with a point of its own.
    """
    peak_c = AIR_C + warmer_c(seconds)
    points = [(0.0, AIR_C), (0.5 * seconds, peak_c), (0.98 * seconds, AIR_C)]
    return [Ambient(at_s=start_s + time_s, temp_c=temp_c) for time_s, temp_c in points]
