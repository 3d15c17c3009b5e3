"""The rate error of a session second by second, real and simulated, before and after the causes are added."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.signal import periodogram

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.block_residuals import block_residual_dps
from gyrodrift.diagnose.features.spectral_line import windows_within
from gyrodrift.diagnose.inference.verdict import NamedCause
from gyrodrift.diagnose.predictive_checks.change_points import ChangePoint, change_points_of
from gyrodrift.diagnose.recording.outliers import Cleaned
from gyrodrift.diagnose.simulate.noise_beneath import with_noise_beneath
from gyrodrift.diagnose.simulate.twin import Subject

FEW_WINDOWS = 4
"""With fewer that rest, those that turn steadily have to do."""

BINS = 60
"""Of the logarithm of the frequency: neighbours in a bin are averaged."""


@dataclass(frozen=True, slots=True, eq=False)
class Spectra:
    """Two-sided amplitude densities, deg/s/√Hz, shape (frequencies,) each; white noise lies at its noise_dps_rthz."""

    hz: Floats
    real: Floats
    before: Floats
    after: Floats


def spectra_of(subject: Subject, before: Cleaned, after: Cleaned) -> tuple[Spectra, Spectra]:
    """Of a session, and of the simulator driven through its motion: below and above half a hertz."""
    # The rebuilt motion holds the encoder's noise: at rest the recording did not feel it, and the simulator did.
    moved_dps = subject.design.motion.rate_dps
    slow = [_slow(subject, seen) for seen in (subject.cleaned, before, after)]
    errors_dps = (subject.cleaned.rate_dps, before.rate_dps - moved_dps, after.rate_dps - moved_dps)
    return _spectra(slow), _spectra([_quick(subject, error_dps) for error_dps in errors_dps])


def _spectra(parts: Sequence[tuple[Floats, Floats]]) -> Spectra:
    return Spectra(parts[0][0], *(np.sqrt(0.5 * power) for _, power in parts))


def _slow(subject: Subject, seen: Cleaned) -> tuple[Floats, Floats]:
    residual_dps = block_residual_dps(seen, subject.design)
    hz, power = periodogram(residual_dps, 1.0 / (subject.design.block * subject.design.period_s), "hann")
    return hz[1:], power[1:]


def _quick(subject: Subject, error_dps: Floats) -> tuple[Floats, Floats]:
    """Frequencies that seconds do not reach; none where nothing rests or turns steadily for a window."""
    design = subject.design
    windows = windows_within(error_dps, design.regimes.at_rest)
    if len(windows) < FEW_WINDOWS:
        windows = windows_within(error_dps, design.regimes.at_rest | design.regimes.is_steady)
    if not len(windows):
        return np.zeros(0), np.zeros(0)
    hz, powers = periodogram(windows, 1.0 / design.period_s, "hann", detrend="linear")
    above = hz > 0.5 / (design.block * design.period_s)
    return hz[above], powers[:, above].mean(axis=0)


def pooled(every: Sequence[Spectra]) -> Spectra:
    """Root mean squares over sessions and over neighbouring frequencies; empty where all are."""
    every = [one for one in every if len(one.hz)]
    if not every:
        return Spectra(*[np.zeros(0)] * 4)
    hz = np.geomspace(min(one.hz[0] for one in every), max(one.hz[-1] for one in every), BINS)

    def of_all(of: Callable[[Spectra], Floats]) -> Floats:
        rows = np.array([_binned(hz, one.hz, np.square(of(one))) for one in every])
        known = np.isfinite(rows)
        sums, counts = np.where(known, rows, 0.0).sum(axis=0), known.sum(axis=0)
        return np.where(counts > 0, np.sqrt(sums / np.maximum(counts, 1)), np.nan)

    columns: list[Callable[[Spectra], Floats]] = [lambda one: one.real, lambda one: one.before, lambda one: one.after]
    return Spectra(hz, *(of_all(column) for column in columns))


def _binned(hz: Floats, own_hz: Floats, power: Floats) -> Floats:
    """Means about each frequency; straight lines where a bin is empty, and NaN beyond a session's own range."""
    edges = np.sqrt(hz[1:] * hz[:-1])
    place = np.digitize(own_hz, edges)
    counts = np.bincount(place, minlength=len(hz))
    filled = counts > 0
    sums = np.bincount(place, power, len(hz))[filled]
    return np.interp(hz, hz[filled], sums / counts[filled], left=np.nan, right=np.nan)


@dataclass(frozen=True, slots=True, eq=False)
class ResidualSeries:
    """Mean rate errors of the seconds of a session, each less its median, the bias: deg/s, shape (seconds,) each.

    number
        Of the session, from 1.
    minutes
        Middles of the seconds since the session began.
    real_dps, before_dps, after_dps
        Of the recording, and of the simulator driven through its motion, without the causes and with them.
    left_dps
        Of the recording less that of the simulator with the causes that are not random: what these leave unexplained.
    change_points
        Of what is left.
    slow, quick
        Spectra below and above half a hertz.
    """

    number: int
    name: str
    minutes: Floats
    real_dps: Floats
    before_dps: Floats
    after_dps: Floats
    left_dps: Floats
    change_points: tuple[ChangePoint, ...]
    slow: Spectra
    quick: Spectra


def residual_series_of(subject: Subject, causes: tuple[NamedCause, ...], number: int) -> ResidualSeries:
    """Replay a session with and without the causes; its number is the seed."""
    design = subject.design
    certain = tuple(cause for cause in causes if not cause.cause.is_random)
    before, after, steady = _replays(subject, [(), causes, certain], number)
    real_dps = block_residual_dps(subject.cleaned, design)
    slow, quick = spectra_of(subject, before, after)
    left_dps = _level(real_dps - block_residual_dps(steady, design))
    return ResidualSeries(
        number=number,
        name=subject.cleaned.recording.name,
        minutes=minutes_of(subject),
        real_dps=_level(real_dps),
        before_dps=_level(block_residual_dps(before, design)),
        after_dps=_level(block_residual_dps(after, design)),
        left_dps=left_dps,
        change_points=change_points_of(left_dps, design.regimes.block_is_even),
        slow=slow,
        quick=quick,
    )


def minutes_of(subject: Subject) -> Floats:
    """Middles of the seconds since the session began."""
    seconds: Floats = (
        np.arange(0.5, len(subject.design.regimes.block_rate_dps)) * subject.design.block * subject.design.period_s
    )
    return seconds / 60.0


def _level(values_dps: Floats) -> Floats:
    level: Floats = values_dps - np.median(values_dps)
    return level


def _replays(subject: Subject, sets: Sequence[tuple[NamedCause, ...]], seed: int) -> list[Cleaned]:
    """A replay for each set of causes; sets that are the same are played once."""
    played: list[Cleaned] = []
    for at, causes in enumerate(sets):
        first = sets.index(causes)
        effects = tuple(cause.in_session(seed - 1, subject.rig.effects) for cause in causes)
        is_new = first == at
        played.append(with_noise_beneath(subject, effects).replayed(effects, seed) if is_new else played[first])
    return played
