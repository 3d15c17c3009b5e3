"""Rates of single samples that jump and return: a damaged transfer, not a turn."""

from gyrodrift.filters.attitude.model import AttitudeState
from gyrodrift.values.vectors import Vector

SPIKE_DPS = 300.0
"""Change of a rate between two samples that may be a spike, deg/s. Chosen: hands reach 15 000 deg/s² at 50 Hz."""

LONGEST_SPIKE_S = 0.05
"""Longest time between two samples of which the first may be a spike, s. Chosen: slower streams turn by as much."""

RETURN_SHARE = 0.5
"""Share of the jump within which the next sample has returned. Chosen."""


def mean_rate(s: AttitudeState, dt: float, gyro: Vector) -> Vector:
    """Mean rate over dt up to this sample, deg/s; a suspect sample waits for the next one, and counts then or never."""
    before = s.gyro_dps
    jump = largest_change(gyro, before)
    if s.suspect_s == 0.0:
        if jump < SPIKE_DPS or dt > LONGEST_SPIKE_S:
            s.gyro_dps = gyro
            return middle(before, gyro)
        s.suspect_dps, s.suspect_s = gyro, dt
        return before
    suspect, suspect_s = s.suspect_dps, s.suspect_s
    s.gyro_dps, s.suspect_s = gyro, 0.0
    if jump < RETURN_SHARE * largest_change(suspect, before):
        return middle(before, gyro)
    x, y, z = middle(suspect, gyro)
    share = 0.5 * suspect_s / dt
    return (
        x + share * (suspect[0] - before[0]),
        y + share * (suspect[1] - before[1]),
        z + share * (suspect[2] - before[2]),
    )


def middle(a: Vector, b: Vector) -> Vector:
    """Mean of two rates."""
    return 0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), 0.5 * (a[2] + b[2])


def largest_change(a: Vector, b: Vector) -> float:
    """Largest difference of two rates in an axis."""
    return max(abs(a[0] - b[0]), abs(a[1] - b[1]), abs(a[2] - b[2]))
