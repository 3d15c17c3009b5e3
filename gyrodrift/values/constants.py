"""Physical constants and the ranges of the counters on the wire, each with its source."""

from math import degrees

CLOCK_WRAP_US = 1 << 32
"""Range of the clock of a device, µs: 32 bits, as `micros()` of an Arduino has them."""

CLOCK_MASK = CLOCK_WRAP_US - 1
"""Bits of a time that the clock of a device keeps."""

COUNTER_WRAP = 1 << 16
"""Range of the sample counter of a device: 16 bits (docs/protocols.md, the native protocol)."""

COUNTER_MASK = COUNTER_WRAP - 1
"""Bits of a count that the counter of a device keeps."""

DEG_PER_RAD = degrees(1.0)
"""Degrees in a radian, 180/π."""

DELTA_GAP_S, DELTA_GAP_PERIODS = 0.25, 4.0
"""After a step longer than both, in s and usual periods, an angle since the last sample is that of one period.

Shorter steps may be jitter of the clock, over which the sum of the angles must not change.
"""

FULL_TURN_DEG = 360.0
"""Degrees in a turn."""

INT16_COUNTS = 32768.0
"""Counts of a signed number of 16 bits at its full scale."""

LINE_BITS_PER_BYTE = 10
"""Bits of a byte on a serial line: start bit, eight data bits, stop bit (8N1)."""

NORMAL_MAD = 1.4826
"""Standard deviation of normal numbers over their median absolute deviation: 1/Φ⁻¹(3/4)."""

NS_PER_S = 1_000_000_000
"""Nanoseconds in a second."""

SECONDS_PER_HOUR = 3600.0
SECONDS_PER_MINUTE = 60.0

STANDARD_GRAVITY_MPS2 = 9.80665
"""Standard acceleration of free fall, m/s² (CGPM 3, 1901; ISO 80000-3). On earth it is 9.76 to 9.84 m/s²."""

US_PER_S = 1e6
"""Microseconds in a second."""

REPEATED_PERIODS = 8.0
"""Longest step back of a clock that is a repeated or swapped reading, in periods; a longer one means a restart."""
