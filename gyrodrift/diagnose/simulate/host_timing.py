"""What is calibrated of the host: how late it has a sample, and by how much that scatters."""

import numpy as np

from firmware_sim.rig import Base
from gyrodrift.arrays import Floats
from gyrodrift.diagnose.recording.recording import Recording

NEIGHBOURS = 100
"""Arrivals whose median is taken away: clocks that wander are no jitter."""

QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95)
EXPONENTIAL_IQR = float(np.log(3.0))
"""Interquartile range of an exponential distribution over its mean."""

LEANING = 0.5
"""A scheduler's delays lean to one side: the lower nine twentieths span 0.28 of what the upper ones do. Waiting for the
tick of a bus spreads evenly, and clocks scatter to both sides: these span 1."""

MOST_DELAY_S = 1.0
"""Clocks that are further apart have zeros of their own, and say nothing of a delay."""


def host_jitter_s(recording: Recording) -> float | None:
    """Mean of the exponential delay that arrivals show; None where there is none to be seen, s."""
    if recording.host_s is None:
        return None
    late_s = _without_wander(recording)
    low, lower, middle, upper, high = np.quantile(late_s, QUANTILES)
    if not (middle - low) < LEANING * (high - middle):
        return None
    return float((upper - lower) / EXPONENTIAL_IQR)


def host_delay_s(recording: Recording) -> float | None:
    """Of the host behind the device, s; None where their clocks have no common zero."""
    ahead_s = recording.host_ahead_s
    return ahead_s if ahead_s is not None and 0.0 <= ahead_s <= MOST_DELAY_S else None


def with_host(base: Base, recording: Recording) -> Base:
    """The base with the delay and jitter of a session, as far as it shows them."""
    shown = {"host_jitter_s": host_jitter_s(recording), "host_delay_s": host_delay_s(recording)}
    return base.model_copy(update={name: value for name, value in shown.items() if value is not None})


def _without_wander(recording: Recording) -> Floats:
    assert recording.host_s is not None  # noqa: S101 - asked before
    away_s = recording.host_s - np.arange(len(recording.host_s)) * recording.period_s
    away_s = away_s[np.isfinite(away_s)]
    rows = away_s[: len(away_s) // NEIGHBOURS * NEIGHBOURS].reshape(-1, NEIGHBOURS)
    if not len(rows):
        rows = away_s[None]
    level: Floats = (rows - np.median(rows, axis=1, keepdims=True)).reshape(-1)
    return level
