"""Accuracy of restlevel on a board: what fewer hypotheses and floats cost on recordings and on the hard cases."""

from collections.abc import Iterator

import numpy as np
import pytest
from c_filter_support import CFilter, CFilters
from c_restlevel_support import SIGMA, YAW, samples
from recordings_support import Recordings

from bench.harness import show
from gyrodrift.evaluation.reference import Reference, reference_of
from gyrodrift.session.files import load_session
from gyrodrift.simulation.hard_cases import CASES, simulation

pytestmark = pytest.mark.timeout(1800)

NUMBERS = (8, 6, 5, 4, 3, 2)
SEED = 1045
FLOAT_SEEDS = (1, 9)
LEAST_DEG = 0.01
"""Errors below the reference's resolution count as this."""


def mean_error_deg(library: CFilter, reference: Reference) -> float:
    """Mean absolute yaw error."""
    t_s = np.cumsum(reference.dt_s)
    yaw_deg = library.run(t_s, samples(reference.rate_dps)).rows[:, YAW]
    return max(LEAST_DEG, float(np.nanmean(np.abs(yaw_deg - reference.reference_deg))))


def recorded(recordings: Recordings) -> Iterator[Reference]:
    """Recordings with a reference."""
    for path in recordings.packed():
        yield reference_of(load_session(path), is_still="temperature" in path.name)


def simulated(seed: int, sessions: int) -> Iterator[Reference]:
    """Sessions of each hard case, at rest and in motion at the start."""
    for case in CASES:
        for number in range(sessions):
            for is_still in (True, False):
                yield reference_of(simulation(case, seed, number, is_still=is_still).whole())


def test_fewer_hypotheses_cost_accuracy(recordings: Recordings) -> None:
    """The default costs nothing against more."""
    filters = CFilters()
    sessions = {"recordings": list(recorded(recordings)), "hard cases": list(simulated(SEED, 2))}
    means: dict[str, dict[int, float]] = {}
    for name, references in sessions.items():
        means[name] = {}
        rows = []
        for number in NUMBERS:
            library = filters.get("filter_restlevel.c", "float", f"-DGD_RESTLEVEL_HYPOTHESES={number}")
            errors = np.array([mean_error_deg(library, reference) for reference in references])
            means[name][number] = float(np.exp(np.log(errors).mean()))
            rows.append((f"{number} hypotheses", f"{means[name][number]:.3f} deg, worst {errors.max():.1f} deg"))
        show(f"{name}: geometric mean of mean absolute yaw errors of {len(references)} sessions", rows)
    for numbers in means.values():
        assert numbers[6] < 1.05 * numbers[8]


def test_floats_cost_little() -> None:
    """Yaw in float against double: a hundredth of a degree, or a small share of a large uncertainty."""
    filters = CFilters()
    single, double = (filters.get("filter_restlevel.c", real) for real in ("float", "double"))
    apart = [apart_deg(single, double, reference) for seed in FLOAT_SEEDS for reference in simulated(seed, 4)]
    worst_deg, worst_share = np.max(apart, axis=0)
    rows = [("largest difference of yaw", f"{worst_deg:.4f} deg"), ("as a share of sigma", f"{worst_share:.1e}")]
    show(f"float against double, {len(apart)} sessions of the hard cases", rows)
    assert worst_deg < 0.05


def apart_deg(single: CFilter, double: CFilter, reference: Reference) -> tuple[float, float]:
    """Largest difference of yaw, and the largest one as a share of its sigma."""
    t_s, inputs = np.cumsum(reference.dt_s), samples(reference.rate_dps)
    whole = double.run(t_s, inputs).rows
    difference_deg = np.abs(single.run(t_s, inputs).rows[:, YAW] - whole[:, YAW])
    return float(difference_deg.max()), float((difference_deg / np.maximum(whole[:, SIGMA], LEAST_DEG)).max())
