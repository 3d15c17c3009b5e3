"""Several effects at once, simulated as a whole: what the tables of single responses are corrected by."""

from collections.abc import Sequence

import numpy as np

from firmware_sim.effects.effect import Effect
from gyrodrift.arrays import Floats
from gyrodrift.diagnose.simulate.candidate import Touches
from gyrodrift.diagnose.simulate.noise_beneath import with_noise_beneath
from gyrodrift.diagnose.simulate.response_table import ResponseTable, SimulatedSet, Sized
from gyrodrift.diagnose.simulate.twin import Subject

FIXED_REALISATIONS, RANDOM_REALISATIONS = 3, 4
"""Of a set without chance of its own, and of one with: their mean is taken. The motion is rebuilt anew with each set,
which moves slow features by chance."""


def change_of(effects: Sequence[Sized], subjects: Sequence[Subject], tables: Sequence[ResponseTable]) -> SimulatedSet:
    """What a whole set of candidates does in all sessions."""
    pairs = enumerate(zip(subjects, tables, strict=True))
    return together([change_in(effects, number, subject, table) for number, (subject, table) in pairs])


def together(sessions: Sequence[SimulatedSet]) -> SimulatedSet:
    """Of all sessions what was simulated in each."""
    changes, variances = np.array([one.change for one in sessions]), np.array([one.variance for one in sessions])
    return SimulatedSet(changes, variances, sessions[0].runs)


def change_in(effects: Sequence[Sized], number: int, subject: Subject, table: ResponseTable) -> SimulatedSet:
    """The same in session `number`."""
    is_random = any(one.is_random for one in effects)
    seeds = range(RANDOM_REALISATIONS if is_random else FIXED_REALISATIONS)
    runs = [table.runs[seed] for seed in seeds]
    changes = np.array(
        [_features(effects, number, subject, seed, run) - run for seed, run in zip(seeds, runs, strict=True)]
    )
    return SimulatedSet(changes.mean(axis=0), changes.var(axis=0, ddof=1), len(changes))


def _features(effects: Sequence[Sized], number: int, subject: Subject, seed: int, run: Floats) -> Floats:
    """(F,) of the set in session `number`; those that it does not touch are taken over from a run without it."""
    of_catalogue = tuple(in_session(one, number, subject) for one in effects if not one.candidate.is_out_of_catalogue)
    calibrated = with_noise_beneath(subject, of_catalogue)
    seen = calibrated.replayed(of_catalogue, seed)
    for one in effects:
        if one.candidate.shape is not None:
            seen = subject.with_shape(one.candidate.shape, one.size, seed, seen)
    if any(one.candidate.touches in (Touches.TIMES, Touches.EVERYTHING) for one in effects):
        return subject.measured_again(seen).values
    values = subject.values_measured_again(seen)
    return np.concatenate([values, run[len(values) :]])


def in_session(one: Sized, number: int, subject: Subject) -> Effect:
    """The effect as it is in session `number`."""
    effect = one.candidate.applied(one.size, subject.rig.effects)
    if one.phases_deg is None:
        return effect
    return effect.model_copy(update={"phase_deg": float(one.phases_deg[number])})
