"""What to do next, in a sentence or two for whoever stands at the bench."""

from collections.abc import Sequence

from gyrodrift.diagnose.next_recording.choose import NextRecording
from gyrodrift.diagnose.next_recording.information import Told
from gyrodrift.diagnose.next_recording.profiles import STILL_S, warmer_c
from gyrodrift.diagnose.next_recording.rig_hypothesis import NOTHING

MOST = 0.99
"""A few simulations can say no more."""


def sentence(found: NextRecording, file: str) -> str:
    """The sentence for `next`; `file` is where the profile is written."""
    what = _told(found.names)
    at_random, probability = f"a motion at random would with {_stated(found.at_random)}", _stated(found.predicted)
    if found.again is not None and not found.is_better_than_again:
        return (
            f"Record {found.minutes:g} min more of the same: it tells {what} with probability {_stated(found.again)}; "
            f"{file} would with {probability}, and {at_random}."
        )
    again = "" if found.again is None else f", and more of the same with {_stated(found.again)}"
    if not found.is_worth_it:
        return (
            f"No motion of {found.minutes:g} min tells {what}: the best, {file}, does so with probability "
            f"{probability}. Record longer and more often."
        )
    words = " and ".join(one.says(found.limits) for one in found.manoeuvres)
    return (
        f"Switch the device on and play {file} ({found.minutes:g} min: {words}){_warming(found)}: "
        f"it tells {what} with probability {probability}; {at_random}{again}."
    )


def _stated(told: Told) -> str:
    return f"{min(told.probability, MOST):.2f}"


def _told(names: Sequence[str]) -> str:
    """`bandwidth from latency`, or `whether there is a deadband`."""
    causes = [name for name in names if name != NOTHING]
    if len(causes) < len(names):
        return f"whether there is {_listed(causes, 'or')}"
    return f"{causes[0]} from {_listed(causes[1:], 'and')}"


def _listed(names: Sequence[str], joint: str) -> str:
    *first, last = names
    return f"{', '.join(first)} {joint} {last}" if first else last


def _warming(found: NextRecording) -> str:
    """When to warm the air, for what a table does not do by itself."""
    seconds = (60.0 * found.minutes - STILL_S) / len(found.manoeuvres)
    starts_s = [STILL_S + number * seconds for number, one in enumerate(found.manoeuvres) if one.warms_air]
    if not starts_s:
        return ""
    times = " and ".join(f"from {start_s:.0f} to {start_s + 0.5 * seconds:.0f} s" for start_s in starts_s)
    return f", and warm the air by {warmer_c(seconds):.0f} °C {times} and let it cool"
