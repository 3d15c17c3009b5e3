"""True motion beside a simulated session of three axes, as numpy arrays in `NAME.truth.npz`.

A session holds what a device sends. The truth is what no device knows: the orientation of the sensor at each sample.
"""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from firmware_sim.measure import Motion
from firmware_sim.triaxial import kinematics_of
from gyrodrift.io.files import whole_file

ENDING = ".truth.npz"

CHUNK_SAMPLES = 1 << 14
"""Samples that are computed together."""


def truth_path(session: Path) -> Path:
    """Path of the truth of a session."""
    return session.with_suffix(ENDING)


def write_truth(session: Path, motion: Motion, seq: NDArray[np.int64], sample_rate_hz: float) -> None:
    """Write the truth at the samples of a session.

    The arrays: seq (n,), t_s (n,) since the beginning, s, and quaternion (n, 4), the rotation w, x, y, z from sensor
    to earth.
    """
    t_s = seq / sample_rate_hz
    parts = [
        kinematics_of(motion, t_s[first : first + CHUNK_SAMPLES]).quaternion
        for first in range(0, len(t_s), CHUNK_SAMPLES)
    ]
    with whole_file(truth_path(session)) as file:
        np.savez_compressed(file, seq=seq, t_s=t_s, quaternion=np.concatenate(parts).astype(np.float32))
