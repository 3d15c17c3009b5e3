"""Sensor: a delay, low-passes of the second and the first order, a tone of the motor or the fan."""

import numpy as np
from scipy.signal import butter, lfilter, sosfilt, sosfilt_zi

from gyrogap.physics.dice import Rng
from gyrogap.physics.motion import Floats
from gyrogap.physics.scene import TableScene, later


def latency(values: Floats, scene: TableScene, rng: Rng, *, delay_ms: float) -> Floats:
    """The rate of a while ago, on the fine grid."""
    return later(values, delay_ms * 1e-3 * scene.fine_hz)


def bandwidth(values: Floats, scene: TableScene, rng: Rng, *, cutoff_hz: float) -> Floats:
    """A second-order low-pass on the fine grid, as the digital filters of these parts are."""
    sections = butter(2, cutoff_hz, fs=scene.fine_hz, output="sos")
    steady = sosfilt_zi(sections) * values[0]
    passed: Floats = sosfilt(sections, values, zi=steady)[0]
    return passed


def one_pole(values: Floats, scene: TableScene, rng: Rng, *, cutoff_hz: float) -> Floats:
    """Bandwidth of a rig file: an RC filter, exact for input that is straight between two points."""
    steps = 2.0 * np.pi * cutoff_hz / scene.fine_hz
    pole = np.exp(-steps)
    mean = (1.0 - pole) / steps
    passed: Floats = lfilter([1.0 - mean, mean - pole], [1.0, -pole], values, zi=[mean * values[0]])[0]
    return passed


def vibration(values: Floats, scene: TableScene, rng: Rng, *, amplitude_dps: float, frequency_hz: float) -> Floats:
    """A tone, there before sampling: above half the sample rate it folds down."""
    return values + amplitude_dps * np.cos(2.0 * np.pi * frequency_hz * scene.fine_s + rng.uniform(0.0, 6.28))
