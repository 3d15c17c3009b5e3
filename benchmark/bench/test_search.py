"""The search methods on equal evaluations: median cost over twenty seeds, on three sets of simulated sessions."""

import sys
from pathlib import Path

import numpy as np
import pytest
from recordings_support import DATA

from bench.harness import show
from firmware_sim.motion.profile import load_profile
from firmware_sim.rig import load_rig, parse_effect, with_effects
from gyrodrift.evaluation.cost import Cost
from gyrodrift.evaluation.dataset import Source, load_with_reference
from gyrodrift.evaluation.space import axes_of
from gyrodrift.filters.hdr_filter import HDR
from gyrodrift.simulation.published_set import read_rows, write_twins
from gyrodrift.simulation.sessions import write_sessions
from gyrodrift.tune.search.methods import METHODS, run_to_budget
from gyrodrift.tune.search.objective import Objective

AXES = axes_of(HDR)

pytestmark = pytest.mark.timeout(7200)

SEEDS = 20
EVALUATIONS = 3000
MARKS = (500, 1000, EVALUATIONS)


def drive(folder: Path) -> list[Path]:
    """Long gentle curves, few stops, a bias that wanders and follows the temperature."""
    rig = with_effects(load_rig(None), [parse_effect("bias_instability"), parse_effect("temp_bias")])
    return list(write_sessions(rig, load_profile("drive"), folder, 5, 8, 15.0))


def warm(folder: Path) -> list[Path]:
    """A turntable that warms up."""
    effects = ["warmup", "rate_random_walk", "scale_factor:error_percent=0.1"]
    rig = with_effects(load_rig(None), [parse_effect(text) for text in effects])
    return list(write_sessions(rig, load_profile("turntable"), folder, 9, 8, 15.0))


def compare(name: str, paths: list[Path]) -> None:
    """Every method with every seed; the default is at least as good as all others in the median."""
    medians: dict[str, np.ndarray[tuple[int], np.dtype[np.float64]]] = {}
    rows = []
    with Cost(load_with_reference(Source(path)).reference for path in paths) as cost:
        for method_name, kind in METHODS.items():
            found = []
            for seed in range(SEEDS):
                method = kind()
                objective = Objective(cost.pi, method.axes(AXES), EVALUATIONS)
                run_to_budget(method, objective, seed)
                best = np.minimum.accumulate(objective.costs)
                found.append([best[mark - 1] for mark in MARKS])
                sys.stderr.write(f"\r{name} {method_name} {seed + 1}/{SEEDS} ")
            medians[method_name] = np.median(found, axis=0)
            texts = [f"{value:.5g}" for value in (*medians[method_name], np.max(found, axis=0)[-1])]
            rows.append((method_name, " / ".join(texts)))
    show(f"{name}: median PI in deg² after {MARKS} evaluations over {SEEDS} seeds / worst at the end", rows)
    assert medians["race"][-1] == min(median[-1] for median in medians.values())


def test_the_default_on_the_twin_of_the_published_set(tmp_path: Path) -> None:
    rows = [row for row in read_rows(DATA / "published_tables.csv") if row.split == "train"]
    compare("twin", [twin.path for twin in write_twins(rows, load_rig(None), tmp_path, seed=1)])


def test_the_default_on_drives(tmp_path: Path) -> None:
    compare("drive", drive(tmp_path))


def test_the_default_on_a_turntable_that_warms_up(tmp_path: Path) -> None:
    compare("warm-up", warm(tmp_path))
