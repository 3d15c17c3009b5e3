"""Constants of physics, arithmetic and standards, alphabetical, each with its source."""

FULL_TURN_DEG = 360.0
"""Degrees in a full turn."""

NS_PER_S = 1_000_000_000
"""Nanoseconds in a second."""
