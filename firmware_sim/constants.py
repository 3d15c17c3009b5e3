"""Constants of physics, each with its source."""

STANDARD_GRAVITY_MPS2 = 9.80665
"""1 g in m/s² (ISO 80000-3)."""
