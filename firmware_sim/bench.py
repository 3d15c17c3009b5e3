"""The whole bench: profile → gyro and encoder → measurements, block by block, so that memory stays bounded.

The same rig, profile and seed give the same measurements, whatever the size of the blocks.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from firmware_sim import encoder
from firmware_sim.gyro import Gyro
from firmware_sim.motion import Floats, Profile
from firmware_sim.rig import Rig

AMBIENT_C = 25.0


@dataclass(frozen=True, slots=True)
class Block:
    """Measurements in the order they were taken; every array has the shape (n,).

    seq
        Counter from 0, not wrapped.
    t_device_us
        Device clock from 0, µs, not wrapped.
    rate_raw, is_clipped
        Rate in counts, and whether it left the range.
    temp_centi_c
        Temperature, hundredths of °C.
    encoder_counts
        Encoder from 0; zeros where the rig has none.
    """

    seq: NDArray[np.int64]
    t_device_us: NDArray[np.int64]
    rate_raw: NDArray[np.int16]
    is_clipped: NDArray[np.bool_]
    temp_centi_c: NDArray[np.int16]
    encoder_counts: NDArray[np.int64]

    def rows(self) -> Iterator[tuple[int, int, int, bool, int, int]]:
        """One measurement after the other, as plain numbers in the order of the arrays."""
        return zip(
            self.seq.tolist(),
            self.t_device_us.tolist(),
            self.rate_raw.tolist(),
            self.is_clipped.tolist(),
            self.temp_centi_c.tolist(),
            self.encoder_counts.tolist(),
            strict=True,
        )


def measure(rig: Rig, profile: Profile, seed: int, block_samples: int = 4096) -> Iterator[Block]:
    """Measurements of a rig that plays a profile, without end."""
    base = rig.base
    gyro = Gyro(base, np.random.default_rng(seed))
    first = 0
    while True:
        seq = np.arange(first, first + block_samples)
        t_s: Floats = seq / base.sample_rate_hz
        angle_deg, rate_dps = profile.at(t_s)
        rate_raw, is_clipped = gyro.measure(rate_dps)
        yield Block(
            seq=seq,
            t_device_us=np.rint(t_s * 1e6).astype(np.int64),
            rate_raw=rate_raw,
            is_clipped=is_clipped,
            temp_centi_c=np.full(block_samples, round(AMBIENT_C * 100), np.int16),
            encoder_counts=encoder.counts(angle_deg, base.encoder_cpr),
        )
        first += block_samples
