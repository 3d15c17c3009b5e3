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

STANDARD_GRAVITY_MPS2 = 9.80665
"""Standard acceleration of free fall (3rd General Conference on Weights and Measures, 1901)."""
