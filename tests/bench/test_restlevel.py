"""What a step of restlevel costs, how good it is on the hard cases over seeds, and whether its sigma is right."""

import time
from typing import Any

import numpy as np
import pytest
from bench_support import show

from gyrodrift.evaluation.kernels.restlevel import walk
from gyrodrift.evaluation.reference import Reference, reference_of
from gyrodrift.evaluation.score import score_of
from gyrodrift.filters.hdr import HdrParams, HdrState
from gyrodrift.filters.hdr import coefficients as hdr_coefficients
from gyrodrift.filters.hdr import step as hdr_step
from gyrodrift.filters.restlevel.model import RestlevelParams, RestlevelState
from gyrodrift.filters.restlevel.step import coefficients, step
from gyrodrift.simulation.hard_cases import CASES, simulation

pytestmark = [pytest.mark.bench, pytest.mark.timeout(1200)]

SEEDS = range(101, 106)
SESSIONS = 2


def reference(case: int, seed: int, number: int, *, is_still: bool) -> Reference:
    """One session of a hard case as tuning sees it."""
    return reference_of(simulation(CASES[case], seed, number, is_still=is_still).whole())


def test_hard_cases_over_seeds() -> None:
    """E in deg and the share of time within two sigma, as the mean and the range over seeds."""
    rows, shares = [], []
    for case in range(len(CASES)):
        for is_still in (True, False):
            found = np.array([judged(case, seed, is_still=is_still) for seed in SEEDS])
            e_deg, inside = found[:, 0], found[:, 1]
            shares.append(inside.mean())
            name = f"{CASES[case].name}, {'still' if is_still else 'moving'}"
            rows.append((name, f"{e_deg.mean():.3g} deg ({e_deg.min():.3g} to {e_deg.max():.3g}), {inside.mean():.0%}"))
    rows.append(("within two sigma, all of them", f"{np.mean(shares):.1%}"))
    show(f"Restlevel on the hard cases, {len(SEEDS)} seeds of {SESSIONS} sessions", rows)


def judged(case: int, seed: int, *, is_still: bool) -> tuple[float, float]:
    """Mean E in deg, and the share of time within two sigma."""
    found = []
    for number in range(SESSIONS):
        one = reference(case, seed, number, is_still=is_still)
        yaw_deg, sigma_deg, _ = walk(one.dt_s, one.rate_dps, RestlevelParams())
        known = np.isfinite(one.reference_deg)
        off_deg = np.abs(yaw_deg - one.reference_deg)[known]
        found.append((score_of(one, yaw_deg).e_deg, float(np.mean(off_deg <= 2.0 * sigma_deg[known] + 1e-9))))
    e_deg, inside = np.mean(found, axis=0)
    return float(e_deg), float(inside)


def seconds(times_s: list[float], rates_dps: list[float], stepping: Any, c: Any, state: Any) -> float:
    """Of one step, in the mean over a session; of the processor, so that others on the machine count less."""
    start_s = time.process_time()
    for t_s, rate_dps in zip(times_s, rates_dps, strict=True):
        stepping(c, state, t_s, rate_dps)
    return (time.process_time() - start_s) / len(times_s)


def test_a_step_beside_one_of_hdr() -> None:
    """In plain Python, on a turntable at 100 Hz: the best of five rounds, in which they take turns."""
    one = reference(0, 101, 0, is_still=True)
    times_s, rates = np.cumsum(one.dt_s).tolist(), one.rate_dps.tolist()
    hdr, own = hdr_coefficients(HdrParams()), coefficients(RestlevelParams())
    rounds = [
        (
            seconds(times_s, rates, hdr_step, hdr, HdrState()),
            seconds(times_s, rates, step, own, RestlevelState()),
        )
        for _ in range(5)
    ]
    hdr_s, own_s = np.min(rounds, axis=0)
    rows = [("hdr", f"{hdr_s * 1e6:.2f} µs"), ("restlevel", f"{own_s * 1e6:.2f} µs, {own_s / hdr_s:.1f} times that")]
    show("A step", rows)
