"""Limits of times and rates in a filter: far beyond every clock and gyro, and their squares are finite floats."""

MOST_S = 1e15
"""Largest absolute device time, s; beyond it a float does not resolve 0.1 s."""

MOST_DPS = 1e12
"""Largest absolute rate, deg/s."""

LEAST_STEP_S = 1e-12
"""Smallest step between two samples, s; no device clock is finer."""
