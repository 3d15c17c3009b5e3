"""The rate error of a session second by second, real and simulated, before and after the causes are added."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.block_residuals import block_residual_dps
from gyrodrift.diagnose.inference.verdict import NamedCause
from gyrodrift.diagnose.predictive_checks.change_points import ChangePoint, change_points_of
from gyrodrift.diagnose.predictive_checks.spectra import Spectra, spectra_of
from gyrodrift.diagnose.recording.outliers import Cleaned
from gyrodrift.diagnose.simulate.noise_beneath import with_noise_beneath
from gyrodrift.diagnose.simulate.twin import Subject


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
    real_dps = block_residual_dps(subject.seen, design)
    slow, quick = spectra_of(subject, before, after)
    left_dps = _level(real_dps - block_residual_dps(steady, design))
    return ResidualSeries(
        number=number,
        name=subject.seen.recording.name,
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
        played.append(played[first] if first < at else _replayed(subject, causes, seed))
    return played


def _replayed(subject: Subject, causes: tuple[NamedCause, ...], seed: int) -> Cleaned:
    effects = tuple(cause.in_session(seed - 1, subject.rig.effects) for cause in causes)
    return with_noise_beneath(subject, effects).replayed(effects, seed)
