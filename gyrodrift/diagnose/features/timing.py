"""Clock and link: what the stamps and arrivals of the samples say, measured in their distance."""

import numpy as np

from gyrodrift.arrays import Floats, Mask
from gyrodrift.diagnose.features.feature import Feature, Measured
from gyrodrift.diagnose.recording.recording import Recording, line

QUANTILES = (0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99)
SCATTER_POINTS = 100
SLOW_S = 10.0
"""Means of stamps over so long show how a clock wanders, without their scatter."""

FEATURES = (
    Feature("clock_ratio", "clock", "always", "the device clock runs fast or slow against the host's"),
    Feature("stamp_scatter", "clock", "always", "device times scatter from sample to sample"),
    Feature("stamp_tails", "clock", "always", "some device times are far off"),
    Feature("stamp_step", "clock", "always", "the device clock jumps"),
    Feature("stamp_wander", "clock", "always", "the device clock wanders"),
    Feature("arrival_scatter", "link", "always", "arrivals scatter from sample to sample"),
    *(
        Feature(f"arrival_gap_{round(100 * q)}", "link", "always", "the gaps between arrivals are spread differently")
        for q in QUANTILES
    ),
    Feature("arrival_wander", "link", "always", "arrivals wander slowly against the samples"),
    Feature("arrival_step", "link", "always", "arrivals are shifted at once"),
    Feature("drop_share", "link", "always", "samples are missing"),
    Feature("drop_runs", "link", "always", "several samples in a row are missing"),
    Feature("repeat_share", "link", "always", "samples come twice"),
    Feature("disorder_share", "link", "always", "samples come in the wrong order"),
)

FLOORS = np.array([1e-5, 0.35, 0.01, 1.0, 1.0, 0.5] + [0.06] * len(QUANTILES) + [0.6, 0.7, 0.005, 0.3, 0.005, 0.005])
LEAST_STAMP_S, LEAST_ARRIVAL_S = 3e-5, 5e-4
"""Scatter below these is nobody's trouble: logarithms are taken over them."""


def measure(recording: Recording) -> Measured:
    """FEATURES of a recording or of a simulation; what it has no times for is 0."""
    period_s = recording.period_s
    device_slope_s, device_offset_s = line(recording.device_s)
    off_s = recording.device_s - device_offset_s - device_slope_s * np.arange(len(recording.device_s))
    ratio = device_slope_s / period_s - 1.0 if recording.host_s is not None else 0.0
    present = np.isfinite(recording.device_s)
    values = [ratio, *_stamps(off_s[present], period_s), *_arrivals(recording.host_s, period_s)]
    share, runs = _drops(present)
    samples = len(present)
    values += [
        np.sqrt(share),
        runs,
        np.sqrt(recording.repeated / samples),
        np.sqrt(recording.disordered / samples),
    ]
    return Measured(np.array(values), FLOORS)


def _stamps(off_s: Floats, period_s: float) -> list[float]:
    """Scatter, tails, largest step and wander of the stamps about their line."""
    quick_s = np.diff(off_s, 2)
    scatter_s = float(np.median(np.abs(quick_s))) / 0.6745 / np.sqrt(6.0)
    tails = np.mean(np.abs(quick_s) > 8.0 * np.sqrt(6.0) * max(scatter_s, LEAST_STAMP_S))
    slow_s = _slow(off_s, period_s)
    return [
        float(np.log(scatter_s + LEAST_STAMP_S)),
        float(np.sqrt(tails)),
        float(np.log(np.abs(np.diff(slow_s)).max(initial=0.0) + LEAST_ARRIVAL_S)),
        float(np.log(np.std(slow_s) + LEAST_ARRIVAL_S)),
    ]


def _arrivals(host_s: Floats | None, period_s: float) -> list[float]:
    if host_s is None:
        return [0.0] * (1 + len(QUANTILES) + 2)
    slope_s, offset_s = line(host_s)
    there = np.isfinite(host_s)
    off_s = (host_s - offset_s - slope_s * np.arange(len(host_s)))[there]
    scatter_s = float(np.std(_quick(off_s)))
    gaps = np.diff(host_s)
    gaps = gaps[np.isfinite(gaps)] / period_s
    slow_s = _slow(off_s, period_s)
    return [
        float(np.log(scatter_s + LEAST_ARRIVAL_S)),
        *np.quantile(gaps, QUANTILES).tolist(),
        float(np.log(np.std(slow_s) + LEAST_ARRIVAL_S)),
        float(np.log(np.abs(np.diff(slow_s)).max(initial=0.0) + LEAST_ARRIVAL_S)),
    ]


def _quick(off_s: Floats) -> Floats:
    """Away from the mean of its neighbours, SCATTER_POINTS at a time; shape (n − some,)."""
    count = len(off_s) // SCATTER_POINTS
    rows = off_s[: count * SCATTER_POINTS].reshape(count, SCATTER_POINTS)
    away: Floats = (rows - rows.mean(axis=1, keepdims=True)).reshape(-1)
    return away


def _slow(off_s: Floats, period_s: float) -> Floats:
    points = max(1, round(SLOW_S / period_s))
    count = len(off_s) // points
    return np.median(off_s[: count * points].reshape(count, points), axis=1) if count > 1 else np.zeros(2)


def _drops(present: Mask) -> tuple[float, float]:
    """Share of samples that are missing, and the logarithm of how many go at a time."""
    missing = ~present
    if not missing.any():
        return 0.0, 0.0
    begins = np.count_nonzero(missing[1:] & ~missing[:-1]) + int(missing[0])
    return float(missing.mean()), float(np.log(float(missing.sum()) / max(float(begins), 1.0)))
