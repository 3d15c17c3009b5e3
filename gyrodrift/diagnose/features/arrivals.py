"""The link: how samples arrive, and which of them never do, come twice or late."""

from dataclasses import dataclass

import numpy as np

from gyrodrift.arrays import Floats, Mask
from gyrodrift.diagnose.features.feature import ResponseLaw, Statistic
from gyrodrift.diagnose.features.stamps import log_largest_step, log_wander, off_line_s, slow_medians
from gyrodrift.diagnose.features.units import MILLISECONDS, PERCENT_OF_SAMPLES, SAMPLE_PERIODS, SAMPLES
from gyrodrift.diagnose.recording.recording import Recording

QUANTILES = (0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99)
"""Of the gaps between arrivals: bunches take some to nothing and leave long ones between."""

NEIGHBOURS = 100
"""Arrivals whose mean each of them is compared with."""

LEAST_ARRIVAL_S = 5e-4
"""Added before a logarithm is taken: 0.5 ms of scatter, 5 % of a sample period at 100 Hz, is practically negligible."""


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
    """What the features of the arrivals are computed from; None without a host's clock."""
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


# fmt: off
ARRIVALS: tuple[Statistic[Arrivals], ...] = (
    Statistic(
        "arrival_scatter", "link", "always", "arrivals scatter from sample to sample", 0.5,
        "0.5 in ln: two thirds of the scatter, and 0.3 ms of none", reading=MILLISECONDS,
        response=ResponseLaw.LOG_VARIANCE, compute=lambda arrivals: float(np.log(arrivals.scatter_s + LEAST_ARRIVAL_S)),
    ),
    *(_gap(number, quantile) for number, quantile in enumerate(QUANTILES)),
    Statistic(
        "arrival_wander", "link", "always", "arrivals wander slowly against the samples", 0.6,
        "0.6 in ln: 0.4 ms where they did not wander", reading=MILLISECONDS,
        compute=lambda arrivals: log_wander(arrivals.slow_s),
    ),
    Statistic(
        "arrival_step", "link", "always", "arrivals are shifted at once", 0.7,
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
