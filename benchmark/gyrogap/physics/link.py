"""Clock and link: stamps in seconds of the device clock, arrivals in seconds of the session, rows by number."""

import numpy as np

from gyrogap.physics.dice import Rng
from gyrogap.physics.motion import Floats
from gyrogap.physics.scene import TableScene

LEAST_STEP_S = 1e-6


def clock_drift(values: Floats, scene: TableScene, rng: Rng, *, ppm: float) -> Floats:
    """The crystal is off, since power-on."""
    return values * (1.0 + ppm * 1e-6)


def timestamp_jitter(values: Floats, scene: TableScene, rng: Rng, *, sigma_ms: float) -> Floats:
    """A busy loop reads the clock when it comes to it; the clock never runs backwards."""
    ticks = LEAST_STEP_S * np.arange(len(values))
    scattered = values + rng.normal(0.0, sigma_ms * 1e-3, len(values))
    ordered: Floats = np.maximum.accumulate(np.maximum(scattered, 0.0) - ticks) + ticks
    return ordered


def usb_batching(values: Floats, scene: TableScene, rng: Rng, *, interval_ms: float) -> Floats:
    """The adapter hands over what it has at its next poll."""
    interval_s = interval_ms * 1e-3
    phase_s = rng.uniform(0.0, interval_s)
    polled: Floats = np.ceil((values - phase_s) / interval_s) * interval_s + phase_s
    return polled


def sample_drop(values: Floats, scene: TableScene, rng: Rng, *, share_percent: float) -> Floats:
    """Rows that never come."""
    kept: Floats = values[rng.random(len(values)) >= share_percent / 100.0]
    return kept
