"""Largest numbers that a gyro with an accelerometer can send; larger ones are damage, or have an impossible scale."""

from collections.abc import Sequence

from gyrodrift.values.sample import Inertial

MAX_RATE_DPS = 2e4
"""Several times the range of gyros on the market."""

MAX_CSV_DPS = 1e7
"""Largest number of csv, whose unit may be wrong: several times that range in mdps, for the judge of its shape."""

MAX_FORCE_MPS2 = 1e4
"""Several times the range of accelerometers on the market."""


def inertial_of(rates_dps: Sequence[float], forces_mps2: Sequence[float] | None) -> Inertial | None:
    """All axes; None without three plausible rates. Accelerations need three plausible ones, too."""
    if len(rates_dps) != 3 or not all(abs(rate_dps) <= MAX_RATE_DPS for rate_dps in rates_dps):
        return None
    if forces_mps2 is None or not all(abs(force_mps2) <= MAX_FORCE_MPS2 for force_mps2 in forces_mps2):
        return Inertial(*rates_dps)
    return Inertial(*rates_dps, *forces_mps2)
