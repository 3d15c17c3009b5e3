"""Where a bias jumps: change points of what is left of the rate error, seen against its noise and its drift."""

from typing import NamedTuple

import numpy as np

from gyrodrift.diagnose.recording import Mask
from gyrodrift.session.session import Floats

WINDOW = 6
"""Seconds before and after a jump that are held against each other."""

SPARE = 3
"""So many of them may be missing."""

CLEAR = 6.0
"""Standard errors: chance reaches 4 in a long session, and what wanders is measured by its own wandering."""

LEAST_DPS = 2e-3
"""Smaller jumps are nobody's trouble."""


class Jump(NamedTuple):
    """The second from which on the level is another one, and by how much, deg/s."""

    second: int
    step_dps: float


def jumps_of(left_dps: Floats, is_even: Mask) -> tuple[Jump, ...]:
    """Of what is left in the seconds that rest or turn evenly; shape (seconds,) each."""
    seconds = np.flatnonzero(is_even)
    if len(seconds) < 4 * WINDOW + 1:
        return ()
    steps_dps = _steps(left_dps[seconds])
    apart = seconds[2 * WINDOW :] - seconds[: -2 * WINDOW]
    steps_dps[WINDOW:-WINDOW][apart > 2 * WINDOW + SPARE] = 0.0
    sizes_dps = np.abs(steps_dps)
    noise_dps = 1.4826 * float(np.median(np.abs(np.diff(left_dps[seconds])))) / np.sqrt(2.0)
    error_dps = max(noise_dps * np.sqrt(3.0 / WINDOW), 1.4826 * float(np.median(sizes_dps)))
    is_clear = sizes_dps > max(CLEAR * error_dps, LEAST_DPS)
    return tuple(Jump(int(seconds[at]), float(steps_dps[at])) for at in _peaks(sizes_dps, is_clear))


def _steps(values: Floats) -> Floats:
    """Mean after less mean before each place, and less the same a window earlier and later, which is drift."""
    sums = np.concatenate([[0.0], np.cumsum(values)])
    means = (sums[WINDOW:] - sums[:-WINDOW]) / WINDOW
    rises = np.zeros(len(values))
    rises[WINDOW : len(values) - WINDOW + 1] = means[WINDOW:] - means[:-WINDOW]
    steps = np.zeros(len(values))
    steps[2 * WINDOW : -2 * WINDOW] = rises[2 * WINDOW : -2 * WINDOW] - 0.5 * (
        rises[WINDOW : -3 * WINDOW] + rises[3 * WINDOW : -WINDOW]
    )
    return steps


def _peaks(sizes: Floats, is_clear: Mask) -> list[int]:
    """The largest of each window."""
    return [
        int(at)
        for at in np.flatnonzero(is_clear)
        if at == at - min(at, WINDOW) + np.argmax(sizes[max(0, at - WINDOW) : at + WINDOW + 1])
    ]
