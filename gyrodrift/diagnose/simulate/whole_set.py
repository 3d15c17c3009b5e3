"""Several effects at once, simulated as a whole: what the tables of single responses are corrected by."""

from collections.abc import Sequence

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.vector import measure
from gyrodrift.diagnose.simulate.candidate import Candidate
from gyrodrift.diagnose.simulate.response_table import ResponseTable
from gyrodrift.diagnose.simulate.twin import Subject

REALISATIONS = 4
"""Of a set in which one at least is random: their mean is taken."""

Sized = tuple[Candidate, float]
"""A candidate with its size."""


def change_of(effects: Sequence[Sized], subjects: Sequence[Subject], tables: Sequence[ResponseTable]) -> Floats:
    """(sessions, F) what a whole set of candidates does to the features."""
    seeds = range(1 if all(candidate.realisations == 1 for candidate, _ in effects) else REALISATIONS)
    changes = [
        np.mean([_features(effects, subject, seed) - table.runs[seed] for seed in seeds], axis=0)
        for subject, table in zip(subjects, tables, strict=True)
    ]
    return np.array(changes)


def _features(effects: Sequence[Sized], subject: Subject, seed: int) -> Floats:
    share = float(np.prod([candidate.noise_share for candidate, _ in effects]))
    of_catalogue = tuple(candidate.make(size) for candidate, size in effects if not candidate.is_out_of_catalogue)
    seen = subject.with_noise(share).replayed(of_catalogue, seed)
    for candidate, size in effects:
        if candidate.shape is not None:
            seen = subject.with_shape(candidate.shape, size, seed, seen)
    return measure(seen, subject.design, subject.facts).values
