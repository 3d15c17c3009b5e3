"""Restlevel on the hard cases of the simulator over seeds: its error, and whether its sigma is right."""

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from evaluate.figures import Figure, mean_figure
from gyrodrift.evaluation.kernels.restlevel import walk
from gyrodrift.evaluation.reference import reference_of
from gyrodrift.evaluation.score import score_of
from gyrodrift.filters.restlevel.model import RestlevelParams
from gyrodrift.simulation.hard_cases import CASES, simulation

SESSIONS = 2
"""Of each case and seed."""


def measure(seed: int, count: int, folder: Path, say: Callable[[str], None]) -> list[Figure]:
    """Mean E of each case, still and moving at first; and the mean share of time outside two sigma."""
    figures, outside = [], []
    for case, hard in enumerate(CASES):
        for is_still in (True, False):
            sessions = list(_judged(case, range(seed, seed + count), is_still=is_still))
            name = f"{hard.name}, {'still' if is_still else 'moving'}"
            figures.append(mean_figure(f"{name}: E in deg", [e_deg for e_deg, _ in sessions]))
            shares = [share for _, share in sessions]
            outside += shares
            say(f"{name}: within two yaw_sigma_deg {1.0 - np.mean(shares):.1%} of the time")
    return [*figures, mean_figure("share of time outside two yaw_sigma_deg", outside)]


def _judged(case: int, seeds: range, *, is_still: bool) -> Iterator[tuple[float, float]]:
    """E in deg and the share of time outside two sigma, of each session."""
    for seed in seeds:
        for number in range(SESSIONS):
            one = reference_of(simulation(CASES[case], seed, number, is_still=is_still).whole())
            yaw_deg, sigma_deg, _ = walk(one.dt_s, one.rate_dps, RestlevelParams())
            known = np.isfinite(one.reference_deg)
            off_deg = np.abs(yaw_deg - one.reference_deg)[known]
            yield score_of(one, yaw_deg).e_deg, float(np.mean(off_deg > 2.0 * sigma_deg[known] + 1e-9))
