"""What tuning pays per sample and candidate, beside the same recursion in scalar C and in numpy."""

import ctypes
import os
import subprocess
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median

import numpy as np

from bench.harness import BENCH, show
from gyrodrift.evaluation.cost import Cost
from gyrodrift.evaluation.reference import Reference
from gyrodrift.values.arrays import Floats

SESSIONS = 10
SAMPLES = 60_000
"""Ten minutes at 100 Hz."""

CANDIDATES = 128
SCALAR_CANDIDATES = 8
NUMPY_CANDIDATES, NUMPY_SAMPLES = 1024, 1000
ROUNDS = 7
DOUBLES = ctypes.POINTER(ctypes.c_double)


def turntable(seed: int) -> Reference:
    """Rests of 25 s and turns of 15 s, with a bias, noise, and times in whole microseconds that scatter."""
    dice = np.random.default_rng(seed)
    t_s = (np.arange(SAMPLES) * 10_000 + dice.integers(-20, 21, SAMPLES)) * 1e-6
    true_dps = np.where(t_s % 40.0 > 25.0, 30.0 * np.sin(2.0 * np.pi * t_s / 15.0), 0.0)
    dt_s = np.diff(t_s, prepend=t_s[0])
    rate_dps = np.round((true_dps + 0.2 + dice.normal(0.0, 0.1, SAMPLES)) / 0.00763) * 0.00763
    return Reference(f"turntable-{seed}", dt_s, rate_dps, np.cumsum(true_dps * dt_s), SAMPLES / 6000.0)


def candidates(count: int) -> Floats:
    """Over the ranges that tuning searches."""
    dice = np.random.default_rng(1)
    factors = [10.0 ** dice.uniform(np.log10(low), np.log10(high), count) for low, high in SEARCHED]
    return np.column_stack([*factors, *dice.uniform(0.0, 3.0, (2, count))])


SEARCHED = ((1e-6, 0.1), (1e-3, 30.0), (0.02, 20.0))


def scalar(folder: Path) -> Callable[[Reference, Floats], Floats]:
    """The C loop, compiled here: sums of squares of candidates one after the other."""
    library = folder / "hdr_scalar.so"
    options = ("-O3", "-march=native", "-ffp-contract=off", "-shared", "-fPIC")
    subprocess.run(["gcc", *options, "-o", library, BENCH / "hdr_scalar.c", "-lm"], check=True)
    loop = ctypes.CDLL(str(library)).hdr_squares

    def squares(reference: Reference, params: Floats) -> Floats:
        found = np.empty(len(params))
        arrays = [
            a.ctypes.data_as(DOUBLES)
            for a in (reference.dt_s, reference.rate_dps, reference.reference_deg, params, found)
        ]
        loop(ctypes.c_size_t(len(reference.dt_s)), *arrays[:3], ctypes.c_size_t(len(params)), *arrays[3:])
        return found

    return squares


def in_numpy(reference: Reference, params: Floats) -> Floats:
    """A loop over samples in Python, over candidates in numpy; runs beyond the reference's length do not come."""
    i_c, tau, theta, c1, c2 = params.T.copy()
    lengths = np.arange(1.0, NUMPY_SAMPLES + 1.0)[:, np.newaxis]
    steps = np.vstack([i_c * 0.0, (1.0 + c1) / (1.0 + c1 * lengths**c2) * i_c])
    lpf = omega = np.full(len(params), reference.rate_dps[0])
    i, yaw, squares, run, sign_before = (np.zeros(len(params)) for _ in range(5))
    lanes, run = np.arange(len(params)), run.astype(np.int64)
    for n in range(1, NUMPY_SAMPLES):
        t_s, before, sign = reference.dt_s[n], omega, np.sign(omega)
        run = np.where(sign == sign_before, run + 1, 1)
        i = i - sign * steps[run, lanes] * (np.abs(before) < theta)
        lpf = (reference.rate_dps[n] * t_s + tau * lpf) / (t_s + tau)
        omega, sign_before = lpf + i, sign
        yaw = yaw + (omega + tau / t_s * (omega - before)) * t_s
        squares += (yaw - reference.reference_deg[n]) ** 2
    return squares


def ns(work: Callable[[], object], steps: int) -> float:
    """Time of one call per sample and candidate."""
    start_s = time.perf_counter()
    work()
    return (time.perf_counter() - start_s) / steps * 1e9


def test_nanoseconds_per_sample_and_candidate(tmp_path: Path) -> None:
    """Medians of interleaved rounds; the C loop gives the same bits."""
    references, params, loop = [turntable(seed) for seed in range(SESSIONS)], candidates(CANDIDATES), scalar(tmp_path)
    few, many = params[:SCALAR_CANDIDATES].copy(), candidates(NUMPY_CANDIDATES)
    total = SESSIONS * SAMPLES
    with Cost(references, threads=1) as one, Cost(references) as every:
        squares = np.array([loop(reference, few) for reference in references]) / SAMPLES
        np.testing.assert_array_equal(one.cost(few).mean_squares, squares)
        np.testing.assert_array_equal(every.pi(params[:1]), one.pi(params[:1]))
        rivals: dict[str, tuple[Callable[[], object], int]] = {
            "one core": (lambda: one.pi(params), total * CANDIDATES),
            f"all {every.threads} cores": (lambda: every.pi(params), total * CANDIDATES),
            "a single candidate, all cores": (lambda: every.pi(params[:1]), total),
            "scalar C, one core": (lambda: loop(references[0], few), SAMPLES * SCALAR_CANDIDATES),
            "numpy over 1024 candidates": (lambda: in_numpy(references[0], many), NUMPY_SAMPLES * NUMPY_CANDIDATES),
        }
        times: dict[str, list[float]] = {name: [] for name in rivals}
        for _ in range(ROUNDS):
            for name, (work, steps) in rivals.items():
                times[name].append(ns(work, steps))
    middle = {name: median(found) for name, found in times.items()}
    rows = [(name, f"{middle[name]:.2f} ns ({min(times[name]):.2f})") for name in rivals]
    show("Per sample and candidate, median (and least)", [*rows, ("load of the machine", f"{os.getloadavg()[0]:.1f}")])
    assert middle["one core"] < middle["scalar C, one core"]
