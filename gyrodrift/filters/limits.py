"""Limits of times and rates in a filter: far beyond every clock and gyro, and their squares are finite floats."""

MOST_S = 1e15
"""Largest absolute device time, s. Derived: beyond it a double does not resolve 0.1 s (IEEE 754)."""

MOST_DPS = 1e12
"""Largest absolute rate, deg/s. Chosen: far beyond every gyro, and its square is a finite float."""

LEAST_STEP_S = 1e-12
"""Smallest step between two samples, s. Chosen: no device clock is finer."""

SAME_TIME_S = 1e-6
"""Difference of two times that are the same, s. Chosen: the last digits of a time must not decide where a block or a
mark ends."""
