"""Features of clock and link: time stamps, arrivals, and samples that are missing, repeated or out of order."""

from dataclasses import dataclass

import numpy as np

from gyrodrift.diagnose.features.feature import (
    MILLISECONDS,
    PERCENT_OF_SAMPLES,
    PPM,
    SAMPLE_PERIODS,
    SAMPLES,
    Feature,
    Measured,
    ResponseLaw,
    Statistic,
)
from gyrodrift.diagnose.recording.order_statistics import median, medians, quantiles
from gyrodrift.diagnose.recording.recording import Recording, fit_line
from gyrodrift.values.arrays import Floats, Mask
from gyrodrift.values.constants import NORMAL_MAD

SLOW_S = 10.0
"""Length of the windows, s, whose medians show the wander of a clock without its scatter. Chosen: many samples for a
median, and many windows in a session."""

LEAST_STAMP_S, LEAST_SLOW_S = 3e-5, 5e-4
"""Added before a logarithm. Chosen: a scatter of 0.03 ms and a wander of 0.5 ms are practically negligible. At 100 Hz
they are 0.3 % and 5 % of a sample period."""

TAIL_SIGMAS = 8.0
"""Standard deviations from which on a second difference of stamps counts as an outlier. Chosen: far beyond usual
jitter, whose tails are longer than normal ones."""

BEND_SIGMAS = np.sqrt(6.0)
"""Standard deviation of second differences of white noise, divided by its own."""


@dataclass(frozen=True, slots=True)
class Stamps:
    """Statistics of the device times of received samples.

    ratio
        Sample period by the device's clock divided by that of the host's clock, less 1; 0 without host times.
    bends_s, scatter_s
        Second differences, shape (n − 2,), and the standard deviation of a stamp that follows from them.
    slow_s
        Medians over SLOW_S of the deviations from a line.
    """

    ratio: float
    bends_s: Floats
    scatter_s: float
    slow_s: Floats


def stamps_of(recording: Recording) -> Stamps:
    """Compute the statistics of the device times."""
    slope_s, off_s = off_line_s(recording.device_s)
    bends_s = np.diff(off_s, 2)
    size_s = median(np.abs(bends_s)) if len(bends_s) else 0.0
    return Stamps(
        ratio=slope_s / recording.period_s - 1.0 if recording.host_s is not None else 0.0,
        bends_s=bends_s,
        scatter_s=size_s * NORMAL_MAD / BEND_SIGMAS,
        slow_s=slow_medians(off_s, recording.period_s),
    )


def off_line_s(times_s: Floats) -> tuple[float, Floats]:
    """Slope of times over the sample numbers, s, and deviations of the known times from the line, s."""
    slope_s, offset_s = fit_line(times_s)
    away_s: Floats = times_s - offset_s - slope_s * np.arange(len(times_s))
    is_known = np.isfinite(times_s)
    return slope_s, away_s if is_known.all() else away_s[is_known]


def slow_medians(off_s: Floats, period_s: float) -> Floats:
    """Medians over windows of SLOW_S; two zeros if there are less than two windows."""
    length = max(1, round(SLOW_S / period_s))
    count = len(off_s) // length
    return medians(off_s[: count * length].reshape(count, length)) if count > 1 else np.zeros(2)


def log_wander(slow_s: Floats) -> float:
    """Logarithm of the standard deviation of slow medians."""
    return float(np.log(np.std(slow_s) + LEAST_SLOW_S))


def log_largest_step(slow_s: Floats) -> float:
    """Logarithm of the largest difference of successive slow medians."""
    return float(np.log(np.abs(np.diff(slow_s)).max(initial=0.0) + LEAST_SLOW_S))


def _root_tails(stamps: Stamps) -> float:
    """Square root of the share of second differences beyond TAIL_SIGMAS."""
    if not len(stamps.bends_s):
        return 0.0
    limit_s = TAIL_SIGMAS * BEND_SIGMAS * max(stamps.scatter_s, LEAST_STAMP_S)
    return float(np.sqrt(np.mean(np.abs(stamps.bends_s) > limit_s)))


# fmt: off
STAMPS: tuple[Statistic[Stamps], ...] = (
    Statistic(
        "clock_ratio", "clock", "always", "the device clock runs fast or slow against the host's", 1e-5,
        "10 ppm: 0.004 deg per turn", reading=PPM, response=ResponseLaw.LINEAR, compute=lambda stamps: stamps.ratio,
    ),
    Statistic(
        "stamp_scatter", "clock", "always", "device times scatter from sample to sample", 0.35,
        "0.35 in ln: 40 % of the scatter, and 0.01 ms of none", reading=MILLISECONDS, response=ResponseLaw.LOG_VARIANCE,
        compute=lambda stamps: float(np.log(stamps.scatter_s + LEAST_STAMP_S)),
    ),
    Statistic(
        "stamp_tails", "clock", "always", "some device times are far off", 0.01, "one sample in 10,000",
        reading=PERCENT_OF_SAMPLES, response=ResponseLaw.ROOT_SHARE,
        compute=_root_tails,
    ),
    Statistic(
        "stamp_step", "clock", "always", "the device clock jumps", 1.0, "1 in ln: 0.9 ms where there was no step",
        reading=MILLISECONDS, compute=lambda stamps: log_largest_step(stamps.slow_s),
    ),
    Statistic(
        "stamp_wander", "clock", "always", "the device clock wanders", 1.0, "1 in ln: 0.9 ms where it did not wander",
        reading=MILLISECONDS, compute=lambda stamps: log_wander(stamps.slow_s),
    ),
)
# fmt: on


QUANTILES = (0.05, 0.5, 0.75, 0.95)
"""Quantiles of the gaps between arrivals that are features. Chosen: middle and tails, since bunches make many gaps of
0, and some long gaps."""

NEIGHBORS = 100
"""Arrivals in a group, whose mean is subtracted before the scatter is computed. Chosen: many for a mean, and a clock
hardly wanders within them."""


@dataclass(frozen=True, slots=True)
class Arrivals:
    """Statistics of the arrival times by the host's clock.

    scatter_s
        Standard deviation about the means of groups of NEIGHBORS arrivals.
    gaps
        QUANTILES of the gaps between successive samples, in sample periods.
    slow_s
        Medians over SLOW_S of the deviations from a line.
    """

    scatter_s: float
    gaps: Floats
    slow_s: Floats


def arrivals_of(recording: Recording) -> Arrivals | None:
    """Compute the statistics of the arrivals; None without host times."""
    if recording.host_s is None:
        return None
    _, off_s = off_line_s(recording.host_s)
    gaps = np.diff(recording.host_s)
    gaps = gaps[np.isfinite(gaps)] / recording.period_s
    return Arrivals(
        scatter_s=_scatter_s(off_s),
        gaps=quantiles(gaps, QUANTILES) if len(gaps) else np.zeros(len(QUANTILES)),
        slow_s=slow_medians(off_s, recording.period_s),
    )


def _scatter_s(off_s: Floats) -> float:
    """Standard deviation about the means of groups of NEIGHBORS values, s; 0 for fewer values."""
    count = len(off_s) // NEIGHBORS
    if not count:
        return 0.0
    rows = off_s[: count * NEIGHBORS].reshape(count, NEIGHBORS)
    return float(np.std((rows - rows.mean(axis=1, keepdims=True)).reshape(-1)))


def missing_of(recording: Recording) -> Mask:
    """Samples that were lost, shape (n,)."""
    return ~np.isfinite(recording.device_s)


def _log_run(recording: Recording) -> float:
    """Logarithm of the mean number of samples in a run of lost samples; 0 without a loss."""
    missing = missing_of(recording)
    if not missing.any():
        return 0.0
    begins = np.count_nonzero(missing[1:] & ~missing[:-1]) + int(missing[0])
    return float(np.log(float(missing.sum()) / max(float(begins), 1.0)))


def _root_of_all(count: int, recording: Recording) -> float:
    return float(np.sqrt(count / len(recording.device_s)))


def _gap(index: int, quantile: float) -> Statistic[Arrivals]:
    return Statistic(
        f"arrival_gap_{round(100 * quantile)}", "link", "always", "the gaps between arrivals are spread differently",
        0.06, "6 % of a sample period", reading=SAMPLE_PERIODS, compute=lambda arrivals: arrivals.gaps[index],
    )  # fmt: skip


# 0.5 ms is added to the scatter of arrivals: 5 % of a sample period at 100 Hz, which is negligible.
# fmt: off
ARRIVALS: tuple[Statistic[Arrivals], ...] = (
    Statistic(
        "arrival_scatter", "link", "always", "arrivals scatter from sample to sample", 0.5,
        "0.5 in ln: two thirds of the scatter, and 0.3 ms of none", reading=MILLISECONDS,
        response=ResponseLaw.LOG_VARIANCE, compute=lambda arrivals: float(np.log(arrivals.scatter_s + 5e-4)),
    ),
    *(_gap(index, quantile) for index, quantile in enumerate(QUANTILES)),
    Statistic(
        "arrival_wander", "link", "always", "arrivals wander slowly against the samples", 0.6,
        "0.6 in ln: 0.4 ms where they did not wander", reading=MILLISECONDS,
        compute=lambda arrivals: log_wander(arrivals.slow_s),
    ),
)

LOSSES: tuple[Statistic[Recording], ...] = (
    Statistic(
        "drop_share", "link", "always", "samples are missing", 0.005, "one sample in 40,000",
        reading=PERCENT_OF_SAMPLES, response=ResponseLaw.ROOT_SHARE,
        compute=lambda recording: float(np.sqrt(missing_of(recording).mean())),
    ),
    Statistic(
        "drop_runs", "link", "always", "several samples in a row are missing", 0.3, "0.3 in ln: a third more at a time",
        reading=SAMPLES, compute=_log_run,
    ),
    Statistic(
        "repeat_share", "link", "always", "samples come twice", 0.005, "one sample in 40,000",
        reading=PERCENT_OF_SAMPLES, response=ResponseLaw.ROOT_SHARE,
        compute=lambda recording: _root_of_all(recording.repeated, recording),
    ),
    Statistic(
        "disorder_share", "link", "always", "samples come in the wrong order", 0.005, "one sample in 40,000",
        reading=PERCENT_OF_SAMPLES, response=ResponseLaw.ROOT_SHARE,
        compute=lambda recording: _root_of_all(recording.disordered, recording),
    ),
)
# fmt: on


FEATURES: tuple[Feature, ...] = (*STAMPS, *ARRIVALS, *LOSSES)
THRESHOLDS = np.array([feature.threshold for feature in FEATURES])


def measure(recording: Recording) -> Measured:
    """FEATURES of a recording or simulation; 0 for features of arrivals without host times."""
    stamps, arrivals = stamps_of(recording), arrivals_of(recording)
    values = [
        *(statistic.compute(stamps) for statistic in STAMPS),
        *(0.0 if arrivals is None else statistic.compute(arrivals) for statistic in ARRIVALS),
        *(statistic.compute(recording) for statistic in LOSSES),
    ]
    return Measured(np.array(values), THRESHOLDS)
