"""A recorded session as arrays."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from gyrodrift.arrays import Floats


@dataclass(frozen=True, slots=True)
class Session:
    """What a device sent, in the order it came; every array has the shape (n,), n ≥ 1.

    name
        Name of the file, without its folder and ending.
    t_device_s
        The sensor's own clock, s.
    rate_dps
        Measured yaw rate, deg/s.
    t_host_s, seq, encoder_deg, temp_c
        Arrival time in s, counter, reference angle in degrees, temperature in °C; None where there is none.
        Single missing values are NaN (−1 in `seq`).
    metadata
        Named tables of what was kept beside the samples: device, host, note; empty where the format has none.
    """

    name: str
    t_device_s: Floats
    rate_dps: Floats
    t_host_s: Floats | None = None
    seq: NDArray[np.int64] | None = None
    encoder_deg: Floats | None = None
    temp_c: Floats | None = None
    metadata: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
