"""Round trip: each effect of the catalog through `gyrodrift simulate` and `gyrodrift diagnose` with the shipped rig."""

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from evaluate.figures import Figure, share_figure
from firmware_sim.effects.catalogue import CATALOGUE

SESSIONS, MINUTES, PROFILE = 3, 4, "identify"
SIZES = ("typical", "small")
TIMEOUT_S = 3000.0
"""Limit of one command; on a machine with much else to do, ten minutes are not enough."""

Say = Callable[[str], None]


def measure(seed: int, count: int, folder: Path, say: Say) -> list[Figure]:
    """Shares of effects that come first or tied, and of runs without an effect that say 'none'; `count` seeds each."""
    seeds = range(seed, seed + count)
    nothing = [diagnosis_of("", folder / f"none_{number}", number)["verdict"] == "none" for number in seeds]
    figures = [share_figure("round trip without an effect says none", sum(nothing), len(nothing))]
    for size in SIZES:
        hits = []
        for name in CATALOGUE:
            for number in seeds:
                gap = diagnosis_of(effect_text(name, size), folder / f"{name}_{size}_{number}", number)
                hits.append(names_first_or_tied(gap, name))
                if not hits[-1]:
                    say(f"{name} {size}: {gap['verdict']} {[cause['effect'] for cause in gap['causes']]}")
        figures.append(share_figure(f"round trip, {size}: effect first or tied", sum(hits), len(hits)))
    return figures


def effect_text(name: str, size: str) -> str:
    """An option for `--effect` at the typical or the small size of the catalog."""
    parameters = getattr(CATALOGUE[name], size)
    return f"{name}:" + ",".join(f"{key}={value}" for key, value in parameters.items())


def names_first_or_tied(gap: dict[str, Any], name: str) -> bool:
    """Whether the first cause is the effect or is tied with it."""
    return bool(gap["causes"]) and name in {gap["causes"][0]["effect"], *gap["causes"][0]["tied_with"]}


def diagnosis_of(effect: str, folder: Path, seed: int) -> dict[str, Any]:
    """`gap.json` of simulated sessions with an effect, or with none; an interrupted run goes on."""
    result = folder / "report" / "gap.json"
    if not result.exists():
        options = ["--effect", effect] if effect else []
        sessions = ["--sessions", str(SESSIONS), "--minutes", str(MINUTES), "--profile", PROFILE, "--seed", str(seed)]
        _run("simulate", "--out", str(folder / "sessions"), "--force", *sessions, *options)
        _run("diagnose", str(folder / "sessions"), "--out", str(folder / "report"), "--jobs", "1")
    gap: dict[str, Any] = json.loads(result.read_text())
    return gap


def _run(*words: str) -> None:
    command = [sys.executable, "-m", "gyrodrift", *words, "--quiet"]
    subprocess.run(command, check=True, capture_output=True, timeout=TIMEOUT_S)
