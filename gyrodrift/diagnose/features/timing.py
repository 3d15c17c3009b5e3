"""Features of clock and link: stamps, arrivals, and samples that are missing, repeated or out of order."""

from dataclasses import dataclass

import numpy as np

from gyrodrift.arrays import Floats, Mask
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
from gyrodrift.diagnose.recording.order_statistics import MEDIAN_TO_SIGMA
from gyrodrift.diagnose.recording.recording import Recording, fit_line

SLOW_S = 10.0
"""Medians of times over so long show how a clock wanders, without their scatter."""

LEAST_STAMP_S, LEAST_SLOW_S = 3e-5, 5e-4
"""Added before logarithms are taken: 0.03 ms of scatter, and 0.5 ms of wander, are practically negligible; at 100 Hz
they are 0.3 % and 5 % of a sample period."""

TAIL_SIGMAS = 8.0
BEND_SIGMAS = np.sqrt(6.0)
"""Standard deviation of the second difference of white noise over its own."""


@dataclass(frozen=True, slots=True)
class Stamps:
    """Device times of the samples that came.

    ratio
        Period by the device's clock over that by the host's, less 1; 0 without a host.
    bends_s, scatter_s
        Second differences, shape (n − 2,), and the standard deviation of a stamp that they show.
    slow_s
        Medians over SLOW_S, off their line.
    """

    ratio: float
    bends_s: Floats
    scatter_s: float
    slow_s: Floats


def stamps_of(recording: Recording) -> Stamps:
    """Series that the features of the clock are computed from."""
    slope_s, off_s = off_line_s(recording.device_s)
    bends_s = np.diff(off_s, 2)
    size_s = np.median(np.abs(bends_s)) if len(bends_s) else 0.0
    return Stamps(
        ratio=slope_s / recording.period_s - 1.0 if recording.host_s is not None else 0.0,
        bends_s=bends_s,
        scatter_s=size_s / MEDIAN_TO_SIGMA / BEND_SIGMAS,
        slow_s=slow_medians(off_s, recording.period_s),
    )


def off_line_s(times_s: Floats) -> tuple[float, Floats]:
    """Slope of times over the sample numbers, and how far off that line those lie that are known, s."""
    slope_s, offset_s = fit_line(times_s)
    away_s: Floats = times_s - offset_s - slope_s * np.arange(len(times_s))
    is_known = np.isfinite(times_s)
    return slope_s, away_s if is_known.all() else away_s[is_known]


def slow_medians(off_s: Floats, period_s: float) -> Floats:
    """Medians over SLOW_S; two zeros where there is one only."""
    points = max(1, round(SLOW_S / period_s))
    count = len(off_s) // points
    return np.median(off_s[: count * points].reshape(count, points), axis=1) if count > 1 else np.zeros(2)


def log_wander(slow_s: Floats) -> float:
    """Logarithm of the standard deviation."""
    return float(np.log(np.std(slow_s) + LEAST_SLOW_S))


def log_largest_step(slow_s: Floats) -> float:
    """Logarithm of the largest difference of neighbours."""
    return float(np.log(np.abs(np.diff(slow_s)).max(initial=0.0) + LEAST_SLOW_S))


def _root_tails(stamps: Stamps) -> float:
    """Root of the share of second differences beyond TAIL_SIGMAS."""
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
        reading=PERCENT_OF_SAMPLES, compute=_root_tails,
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


QUANTILES = (0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99)
"""Of the gaps between arrivals: bunches take some to nothing and leave long ones between."""

NEIGHBOURS = 100
"""Arrivals whose mean each of them is compared with."""


@dataclass(frozen=True, slots=True)
class Arrivals:
    """Times of arrival by the host's clock.

    scatter_s
        Standard deviation about the mean of their neighbours.
    gaps
        QUANTILES of the gaps, in sample periods.
    slow_s
        Medians over ten seconds, off their line.
    """

    scatter_s: float
    gaps: Floats
    slow_s: Floats


def arrivals_of(recording: Recording) -> Arrivals | None:
    """Series that the features of the arrivals are computed from; None without the times of a host."""
    if recording.host_s is None:
        return None
    _, off_s = off_line_s(recording.host_s)
    gaps = np.diff(recording.host_s)
    gaps = gaps[np.isfinite(gaps)] / recording.period_s
    return Arrivals(
        scatter_s=_scatter_s(off_s),
        gaps=np.quantile(gaps, QUANTILES) if len(gaps) else np.zeros(len(QUANTILES)),
        slow_s=slow_medians(off_s, recording.period_s),
    )


def _scatter_s(off_s: Floats) -> float:
    count = len(off_s) // NEIGHBOURS
    if not count:
        return 0.0
    rows = off_s[: count * NEIGHBOURS].reshape(count, NEIGHBOURS)
    return float(np.std((rows - rows.mean(axis=1, keepdims=True)).reshape(-1)))


def missing_of(recording: Recording) -> Mask:
    """Which samples never came, shape (n,)."""
    return ~np.isfinite(recording.device_s)


def _log_run(recording: Recording) -> float:
    """Logarithm of how many samples are missing at a time; 0 where none is."""
    missing = missing_of(recording)
    if not missing.any():
        return 0.0
    begins = np.count_nonzero(missing[1:] & ~missing[:-1]) + int(missing[0])
    return float(np.log(float(missing.sum()) / max(float(begins), 1.0)))


def _root_of_all(count: int, recording: Recording) -> float:
    return float(np.sqrt(count / len(recording.device_s)))


def _gap(number: int, quantile: float) -> Statistic[Arrivals]:
    return Statistic(
        f"arrival_gap_{round(100 * quantile)}", "link", "always", "the gaps between arrivals are spread differently",
        0.06, "6 % of a sample period", reading=SAMPLE_PERIODS, compute=lambda arrivals: arrivals.gaps[number],
    )  # fmt: skip


# The scatter of arrivals has 0.5 ms added, 5 % of a period at 100 Hz, which is negligible.
# fmt: off
ARRIVALS: tuple[Statistic[Arrivals], ...] = (
    Statistic(
        "arrival_scatter", "link", "always", "arrivals scatter from sample to sample", 0.5,
        "0.5 in ln: two thirds of the scatter, and 0.3 ms of none", reading=MILLISECONDS,
        response=ResponseLaw.LOG_VARIANCE, compute=lambda arrivals: float(np.log(arrivals.scatter_s + 5e-4)),
    ),
    *(_gap(number, quantile) for number, quantile in enumerate(QUANTILES)),
    Statistic(
        "arrival_wander", "link", "always", "arrivals wander slowly against the samples", 0.6,
        "0.6 in ln: 0.4 ms where they did not wander", reading=MILLISECONDS,
        compute=lambda arrivals: log_wander(arrivals.slow_s),
    ),
    Statistic(
        "arrival_step", "link", "always", "arrivals shift suddenly", 0.7,
        "0.7 in ln: 0.5 ms where there was no step", reading=MILLISECONDS,
        compute=lambda arrivals: log_largest_step(arrivals.slow_s),
    ),
)

LOSSES: tuple[Statistic[Recording], ...] = (
    Statistic(
        "drop_share", "link", "always", "samples are missing", 0.005, "one sample in 40,000",
        reading=PERCENT_OF_SAMPLES, compute=lambda recording: float(np.sqrt(missing_of(recording).mean())),
    ),
    Statistic(
        "drop_runs", "link", "always", "several samples in a row are missing", 0.3, "0.3 in ln: a third more at a time",
        reading=SAMPLES, compute=_log_run,
    ),
    Statistic(
        "repeat_share", "link", "always", "samples come twice", 0.005, "one sample in 40,000",
        reading=PERCENT_OF_SAMPLES, compute=lambda recording: _root_of_all(recording.repeated, recording),
    ),
    Statistic(
        "disorder_share", "link", "always", "samples come in the wrong order", 0.005, "one sample in 40,000",
        reading=PERCENT_OF_SAMPLES, compute=lambda recording: _root_of_all(recording.disordered, recording),
    ),
)
# fmt: on


FEATURES: tuple[Feature, ...] = (*STAMPS, *ARRIVALS, *LOSSES)
THRESHOLDS = np.array([feature.threshold for feature in FEATURES])


def measure(recording: Recording) -> Measured:
    """FEATURES of a recording or of a simulation; what it has no times for is 0."""
    stamps, arrivals = stamps_of(recording), arrivals_of(recording)
    values = [
        *(statistic.compute(stamps) for statistic in STAMPS),
        *(0.0 if arrivals is None else statistic.compute(arrivals) for statistic in ARRIVALS),
        *(statistic.compute(recording) for statistic in LOSSES),
    ]
    return Measured(np.array(values), THRESHOLDS)
