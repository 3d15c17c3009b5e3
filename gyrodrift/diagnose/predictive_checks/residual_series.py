"""Rate error of a session in each second: of the recording, and of the simulator without and with the causes."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from gyrodrift.diagnose.features.block_residuals import block_residual_dps
from gyrodrift.diagnose.features.spectral_line import windows_within
from gyrodrift.diagnose.inference.verdict import NamedCause
from gyrodrift.diagnose.recording.outliers import Cleaned
from gyrodrift.diagnose.simulate.recalibration import recalibrated_with
from gyrodrift.diagnose.simulate.twin import Subject
from gyrodrift.values.arrays import Floats, Integers, Mask
from gyrodrift.values.constants import NORMAL_MAD

LEAST_SECONDS = 10
"""Least distance of two change points, and length of the windows before and after a change point. Chosen: means of
fewer seconds scatter too much."""

CLEAR = 6.0
"""Least difference of the means on both sides of a split, in standard errors. Chosen: chance reaches 4 in a long
session."""

LEAST_DPS = 2e-3
"""Least step, deg/s. Smaller steps are negligible. Derived: it is the relevance threshold of a bias that depends on
angle or direction, `features/columns.py`."""

SUDDEN_SHARE, SUDDEN_CLEAR = 0.6, 5.0
"""Least share of the height of a change point that occurs within its two windows, beyond the drift, and its least size
in standard errors. Chosen: a change that takes longer is a drift."""

OUTLIER_SIGMAS = 4.0
"""Standard deviations from the median of the neighbors beyond which a second is an outlier. Chosen: 1 of 16,000 normal
values lies beyond."""


class ChangePoint(NamedTuple):
    """The first second of a new level, and the step to it, deg/s."""

    second: int
    step_dps: float


def change_points_of(unexplained_dps: Floats, is_even: Mask) -> tuple[ChangePoint, ...]:
    """Change points of the unexplained rate error, from the seconds that rest or turn evenly.

    unexplained_dps, is_even
        (seconds,) unexplained rate error, and whether the device rests or turns evenly.
    """
    seconds = np.flatnonzero(is_even)
    if len(seconds) < 2 * LEAST_SECONDS:
        return ()
    level_dps = unexplained_dps[seconds]
    spread_dps = NORMAL_MAD * float(np.median(np.abs(np.diff(level_dps)))) / np.sqrt(2.0) + 1e-9
    level_dps = _without_outliers(level_dps, OUTLIER_SIGMAS * spread_dps)
    edges = [0, *sorted(_splits(level_dps, spread_dps)), len(seconds)]
    means = [float(level_dps[start:end].mean()) for start, end in pairwise(edges)]
    change_points = []
    for index, height_dps in zip(edges[1:-1], np.diff(means).tolist(), strict=True):
        step_dps, drift_dps = _sudden_step(seconds, level_dps, index)
        # The step beyond the drift has weights 3/2, 3/2, 1/2 and 1/2 of means of LEAST_SECONDS / 2 seconds.
        least_dps = max(SUDDEN_CLEAR * np.sqrt(10.0 / LEAST_SECONDS) * spread_dps, LEAST_DPS)
        beyond_dps = step_dps - drift_dps
        if beyond_dps / height_dps > SUDDEN_SHARE and abs(beyond_dps) > least_dps:
            change_points.append(ChangePoint(int(seconds[index]), step_dps))
    return tuple(change_points)


def _sudden_step(seconds: Integers, level_dps: Floats, index: int) -> tuple[float, float]:
    """Step at a split and the part of it that drift makes, deg/s; 0 and 0 next to an end or a gap.

    The step is the difference of the half windows next to the split. The drift is the mean change from half window to
    half window before and after it.
    """
    near = range(index - LEAST_SECONDS, index + LEAST_SECONDS)
    if near.start < 0 or near.stop > len(seconds) or seconds[near.stop - 1] - seconds[near.start] > 3 * LEAST_SECONDS:
        return 0.0, 0.0
    quarters = level_dps[near.start : near.stop].reshape(4, -1).mean(axis=1)
    drift_dps = (quarters[1] - quarters[0] + quarters[3] - quarters[2]) / 2.0
    return float(quarters[2] - quarters[1]), float(drift_dps)


def _without_outliers(values: Floats, most: float) -> Floats:
    """Values clipped to a distance from the median of five neighbors."""
    padded = np.pad(values, 2, mode="edge")
    around = np.median([padded[shift : shift + len(values)] for shift in range(5)], axis=0)
    clipped: Floats = around + np.clip(values - around, -most, most)
    return clipped


def _splits(values: Floats, spread: float) -> list[int]:
    """Indices of clear splits: the clearest first, then those of its parts, at most 30."""
    splits: list[int] = []
    parts = [(0, len(values))]
    while len(splits) < 30:
        best = max((_split(values[start:end], spread, start) for start, end in parts), key=lambda split: split[1])
        if best[1] < CLEAR:
            break
        splits.append(best[0])
        parts = list(pairwise([0, *sorted(splits), len(values)]))
    return splits


def _split(values: Floats, spread: float, start: int) -> tuple[int, float]:
    """Index of the clearest split of a part, and the difference of the means on its sides in standard errors.

    start
        Index of the first value of the part.
    """
    count = len(values)
    if count < LEAST_SECONDS:
        return start, 0.0
    before = np.arange(LEAST_SECONDS // 2, count - LEAST_SECONDS // 2 + 1)
    sums = np.cumsum(values - values.mean())[before - 1]
    errors = np.abs(sums) / (spread * np.sqrt(before * (count - before) / count))
    best = int(np.argmax(errors))
    return start + int(before[best]), float(errors[best])


FEW_WINDOWS = 4
"""Least number of windows at rest for a spectrum; with fewer windows, steady turns are used too. Chosen: the mean of
fewer scatters by more than half."""

BINS = 60
"""Bins of the logarithm of the frequency in which spectra are averaged. Chosen: enough for the width of a chart."""


@dataclass(frozen=True, slots=True, eq=False)
class Spectra:
    """Two-sided amplitude spectral densities of rate errors, deg/s/√Hz; white noise lies at its `noise_dps_rthz`.

    hz
        (frequencies,) frequencies.
    real, before, after
        (frequencies,) densities of the recording, and of the simulator without and with the causes.
    """

    hz: Floats
    real: Floats
    before: Floats
    after: Floats


def spectra_of(subject: Subject, before: Cleaned, after: Cleaned) -> tuple[Spectra, Spectra]:
    """Spectra below and above half a hertz.

    before, after
        Replays of the session without and with the causes.
    """
    # The rebuilt motion contains noise of the encoder. The simulator was driven by it, the device was not.
    motion_dps = subject.design.motion.rate_dps
    slow = [_slow(subject, cleaned) for cleaned in (subject.cleaned, before, after)]
    errors_dps = (subject.cleaned.rate_dps, before.rate_dps - motion_dps, after.rate_dps - motion_dps)
    return _spectra(slow), _spectra([_quick(subject, error_dps) for error_dps in errors_dps])


def _spectra(parts: Sequence[tuple[Floats, Floats]]) -> Spectra:
    """Spectra from frequencies and one-sided power densities of recording, simulator before and simulator after."""
    return Spectra(parts[0][0], *(np.sqrt(0.5 * power) for _, power in parts))


def _slow(subject: Subject, cleaned: Cleaned) -> tuple[Floats, Floats]:
    """Frequencies up to half a hertz and the one-sided power density of the rate error there."""
    residual_dps = block_residual_dps(cleaned, subject.design)
    hz, power = _periodogram(residual_dps, subject.design.block * subject.design.period_s, 0)
    return hz[1:], power[1:]


def _quick(subject: Subject, error_dps: Floats) -> tuple[Floats, Floats]:
    """Frequencies above half a hertz and the one-sided power density there.

    It is the mean over windows of rest, or else of rest and steady turns; empty if there is no window.
    """
    design = subject.design
    windows = windows_within(error_dps, design.regimes.at_rest)
    if len(windows) < FEW_WINDOWS:
        windows = windows_within(error_dps, design.regimes.at_rest | design.regimes.is_steady)
    if not len(windows):
        return np.zeros(0), np.zeros(0)
    hz, powers = _periodogram(windows, design.period_s, 1)
    above = hz > 0.5 / (design.block * design.period_s)
    return hz[above], powers[:, above].mean(axis=0)


def _periodogram(values: Floats, period_s: float, degree: int) -> tuple[Floats, Floats]:
    """Frequencies and one-sided power density along the last axis, by a Hann window.

    degree
        Degree of the polynomial that is subtracted from the values: 0 or 1.
    """
    count = values.shape[-1]
    window = np.hanning(count + 1)[:-1]
    basis, _ = np.linalg.qr(np.vander(np.arange(count, dtype=np.float64), degree + 1))
    lines = np.fft.rfft((values - (values @ basis) @ basis.T) * window, axis=-1)
    power = 2.0 * period_s * np.square(np.abs(lines)) / np.square(window).sum()
    power[..., [0, -1] if count % 2 == 0 else [0]] *= 0.5  # the constant and half the sample rate have one side
    hz: Floats = np.arange(lines.shape[-1]) / (count * period_s)
    return hz, power


def pooled(spectra: Sequence[Spectra]) -> Spectra:
    """Root mean square over sessions and over neighboring frequencies; empty if all spectra are empty."""
    spectra = [spectrum for spectrum in spectra if len(spectrum.hz)]
    if not spectra:
        return Spectra(*[np.zeros(0)] * 4)
    hz = np.geomspace(min(spectrum.hz[0] for spectrum in spectra), max(spectrum.hz[-1] for spectrum in spectra), BINS)

    def of_all(density: Callable[[Spectra], Floats]) -> Floats:
        rows = np.array([_binned(hz, spectrum.hz, np.square(density(spectrum))) for spectrum in spectra])
        is_covered = np.isfinite(rows)
        sums, counts = np.where(is_covered, rows, 0.0).sum(axis=0), is_covered.sum(axis=0)
        return np.where(counts > 0, np.sqrt(sums / np.maximum(counts, 1)), np.nan)

    columns: list[Callable[[Spectra], Floats]] = [
        lambda spectrum: spectrum.real,
        lambda spectrum: spectrum.before,
        lambda spectrum: spectrum.after,
    ]
    return Spectra(hz, *(of_all(column) for column in columns))


def _binned(hz: Floats, own_hz: Floats, power: Floats) -> Floats:
    """Mean power in the bin of each frequency, interpolated over empty bins; NaN beyond the range of the session."""
    edges = np.sqrt(hz[1:] * hz[:-1])
    bins = np.digitize(own_hz, edges)
    counts = np.bincount(bins, minlength=len(hz))
    filled = counts > 0
    sums = np.bincount(bins, power, len(hz))[filled]
    return np.interp(hz, hz[filled], sums / counts[filled], left=np.nan, right=np.nan)


@dataclass(frozen=True, slots=True, eq=False)
class ResidualSeries:
    """Mean rate errors of a session in each second, without their median, which is the bias.

    number
        Number of the session, from 1.
    minutes
        (seconds,) time from the start of the session to the middle of each second, min.
    real_dps, before_dps, after_dps
        (seconds,) rate errors of the recording, and of the simulator without and with the causes, for the same motion.
    unexplained_dps
        (seconds,) rate error of the recording minus that of the simulator with those causes that are not random.
    change_points
        Change points of the unexplained rate error.
    slow, quick
        Spectra below and above half a hertz.
    """

    number: int
    name: str
    minutes: Floats
    real_dps: Floats
    before_dps: Floats
    after_dps: Floats
    unexplained_dps: Floats
    change_points: tuple[ChangePoint, ...]
    slow: Spectra
    quick: Spectra


def residual_series_of(subject: Subject, causes: tuple[NamedCause, ...], number: int) -> ResidualSeries:
    """Replay a session without and with the causes; its number is the seed."""
    design = subject.design
    deterministic_causes = tuple(cause for cause in causes if not cause.cause.is_random)
    before, after, deterministic = _replays(subject, [(), causes, deterministic_causes], number)
    real_dps = block_residual_dps(subject.cleaned, design)
    slow, quick = spectra_of(subject, before, after)
    unexplained_dps = _without_bias(real_dps - block_residual_dps(deterministic, design))
    return ResidualSeries(
        number=number,
        name=subject.cleaned.recording.name,
        minutes=minutes_of(subject),
        real_dps=_without_bias(real_dps),
        before_dps=_without_bias(block_residual_dps(before, design)),
        after_dps=_without_bias(block_residual_dps(after, design)),
        unexplained_dps=unexplained_dps,
        change_points=change_points_of(unexplained_dps, design.regimes.block_is_even),
        slow=slow,
        quick=quick,
    )


def minutes_of(subject: Subject) -> Floats:
    """(seconds,) time from the start of the session to the middle of each second, min."""
    seconds: Floats = (
        np.arange(0.5, len(subject.design.regimes.block_rate_dps)) * subject.design.block * subject.design.period_s
    )
    return seconds / 60.0


def _without_bias(values_dps: Floats) -> Floats:
    """Rate errors minus their median."""
    unbiased_dps: Floats = values_dps - np.median(values_dps)
    return unbiased_dps


def _replays(subject: Subject, sets: Sequence[tuple[NamedCause, ...]], seed: int) -> list[Cleaned]:
    """Replay a session with each set of causes; equal sets are simulated once."""
    played: list[Cleaned] = []
    for index, causes in enumerate(sets):
        first = sets.index(causes)
        effects = tuple(cause.in_session(seed - 1, subject.rig.effects) for cause in causes)
        is_new = first == index
        played.append(recalibrated_with(subject, effects).replayed(effects, seed) if is_new else played[first])
    return played
