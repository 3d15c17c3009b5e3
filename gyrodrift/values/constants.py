"""Constants of physics, arithmetic and standards, alphabetical, each with its source."""

NORMAL_MAD = 1.4826
"""Standard deviation of normal numbers over their median absolute deviation: 1/Φ⁻¹(3/4)."""

SECONDS_PER_HOUR = 3600.0
SECONDS_PER_MINUTE = 60.0

STANDARD_GRAVITY_MPS2 = 9.80665
"""ISO 80000-3; defined by CGPM 3, 1901. On earth it is 9.76 to 9.84 m/s²."""
