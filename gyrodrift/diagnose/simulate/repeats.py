"""Responses that repeated runs of one motion have in common: they are simulated in two of the runs.

A response depends on motion, temperature, sample period, noise and columns of a recording. Where all of them agree,
another simulation only shows chance, which the null runs of each recording hold already.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from gyrodrift.diagnose.recording.motion import ReplayedMotion
from gyrodrift.diagnose.simulate.candidate import Candidate, Touches
from gyrodrift.diagnose.simulate.response_table import ResponseTable, key
from gyrodrift.diagnose.simulate.twin import Subject
from gyrodrift.values.arrays import Floats

SIMULATED_RUNS = 2
"""Runs of a motion that are simulated. Chosen: two halve the variance by chance of a single run."""

SAME_NOISE, SAME_PERIOD = 1.25, 1.01
"""Ratios up to which noise and period agree. Derived: 0.22 in ln is the relevance threshold of an amplitude of noise,
and 1 % of the period is that of the clocks of gyros."""

SAME_TEMPERATURE_C = 3.0
"""Difference of temperatures, °C, that changes no response. Derived: the shortest length of a random function of
temperature."""

SAME_RATE, SAME_LENGTH = 0.1, 1.02
"""RMS difference of the rates, as a share of the RMS rate, and ratio of the lengths, up to which a motion is the same.
The usual form error of an effect is as large. Chosen."""


def is_shared(candidate: Candidate) -> bool:
    """Whether repeated runs share the response: it takes many simulations, and no absolute angle or level matters."""
    is_played = candidate.shape is None and candidate.touches in (Touches.VALUES, Touches.EVERYTHING)
    return candidate.phase_deg is None and len(candidate.grid_points) > 1 and (is_played or candidate.realisations > 1)


def twins_of(subjects: Sequence[Subject]) -> list[tuple[int, ...]]:
    """Indices of the runs from which a session takes its shared responses; empty if it is simulated itself."""
    simulated: list[list[int]] = []
    twins: list[tuple[int, ...]] = []
    for index, subject in enumerate(subjects):
        runs = next((runs for runs in simulated if _repeats(subject, subjects[runs[0]])), None)
        if runs is None:
            simulated.append([index])
        elif len(runs) < SIMULATED_RUNS:
            runs.append(index)
        twins.append(tuple(runs) if runs is not None and index not in runs else ())
    return twins


def _repeats(second: Subject, first: Subject) -> bool:
    """Whether two recordings have the same motion, temperature, columns, period and noise."""
    facts = [
        (recording.host_s is None, recording.has_counter, recording.gyro_xy_dps is None)
        for recording in (first.cleaned.recording, second.cleaned.recording)
    ]
    bases = [subject.rig.base for subject in (first, second)]
    noise, rate_hz = [base.noise_dps_rthz for base in bases], [base.sample_rate_hz for base in bases]
    is_like = max(noise) <= SAME_NOISE * min(noise) and max(rate_hz) <= SAME_PERIOD * min(rate_hz)
    return is_like and facts[0] == facts[1] and _is_same_motion(first.posterior.mean, second.posterior.mean)


def _is_same_motion(first: ReplayedMotion, second: ReplayedMotion) -> bool:
    """Whether two motions have the same rates and temperatures at the same times, and nearly the same length."""
    lengths = len(first.rate_dps), len(second.rate_dps)
    count = min(lengths)
    away_dps = first.rate_dps[:count] - second.rate_dps[:count]
    away_c = first.sensor_c[:count] - second.sensor_c[:count]
    return bool(
        max(lengths) <= SAME_LENGTH * count
        and np.linalg.norm(away_dps) <= SAME_RATE * np.linalg.norm(first.rate_dps)
        and np.abs(away_c).max() < SAME_TEMPERATURE_C
    )


def with_shared(
    tables: Sequence[ResponseTable], twins: Sequence[Sequence[int]], tried: Sequence[Candidate]
) -> tuple[ResponseTable, ...]:
    """The tables with the responses that they take from other runs."""
    shared = [candidate for candidate in tried if is_shared(candidate)]
    return tuple(
        replace(table, responses={**table.responses, **_taken(shared, [tables[run] for run in runs], index)})
        if runs
        else table
        for index, (table, runs) in enumerate(zip(tables, twins, strict=True))
    )


def _taken(shared: Sequence[Candidate], runs: Sequence[ResponseTable], index: int) -> dict[str, Floats]:
    """Responses of other runs by key: the mean of a deterministic effect, the realizations of one run of a random."""
    taken: dict[str, Floats] = {}
    for name, is_random in ((key(candidate), candidate.realisations > 1) for candidate in shared):
        if name in runs[0].responses:
            every = [run.responses[name] for run in runs]
            taken[name] = every[index % len(runs)] if is_random else np.mean(every, axis=0)
    return taken
