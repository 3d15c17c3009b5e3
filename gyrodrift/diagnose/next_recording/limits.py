"""How fast and how quick a motion may be, so that gyro and encoder both show it."""

from dataclasses import dataclass
from math import pi

from firmware_sim.measure import COUNTS_MAX
from firmware_sim.rig import Base

SHARE_OF_RANGE, FASTEST_DPS = 0.9, 300.0
"""A motion stays within this share of the gyro's range, and within what a small turntable turns."""

WAVE_DPS = 40.0
"""Amplitude of chirps and RMS of multisines times √2."""

COUNTS_PER_SWING = 4.0
"""An encoder shows a swing that takes this many of its counts from end to end."""

SHARE_OF_SAMPLE_RATE, QUICKEST_HZ = 0.25, 12.0
"""Half of what can be sampled; and what a table with a load can follow."""

SLOWEST_HZ = 0.2
"""Where chirps and multisines begin."""


@dataclass(frozen=True, slots=True)
class MotionLimits:
    """Highest rate in deg/s, and the frequency up to which chirps and multisines run, Hz."""

    rate_dps: float
    wave_hz: float

    @property
    def wave_dps(self) -> float:
        """Amplitude of what runs up to that frequency, deg/s."""
        return min(WAVE_DPS, self.rate_dps)


def limits_of(base: Base) -> MotionLimits:
    """Of a gyro and an encoder as a rig states them."""
    rate_dps = min(SHARE_OF_RANGE * COUNTS_MAX * base.dps_per_lsb, FASTEST_DPS)
    swing_deg = COUNTS_PER_SWING * 360.0 / max(1, base.encoder_cpr)
    # From end to end a rate of amplitude a swings the angle by 2a / (2 pi f).
    resolvable_hz = min(WAVE_DPS, rate_dps) / (pi * swing_deg)
    wave_hz = min(resolvable_hz, SHARE_OF_SAMPLE_RATE * base.sample_rate_hz, QUICKEST_HZ)
    return MotionLimits(rate_dps, max(wave_hz, 2.0 * SLOWEST_HZ))
