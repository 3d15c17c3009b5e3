"""What a filter takes for a time and a rate: far beyond every clock and gyro, and squares of it are still floats."""

MOST_S = 1e15
"""Of device time, either way; a float has no tenths of a second there."""

MOST_DPS = 1e12
"""Of a rate, either way."""

LEAST_STEP_S = 1e-12
"""Between two samples; no clock of a device is finer."""
