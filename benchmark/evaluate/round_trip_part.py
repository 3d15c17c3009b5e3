"""Round trip: each effect of the catalog through `gyrodrift simulate` and `gyrodrift diagnose` with the shipped rig."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from this_tree import run_gyrodrift

from evaluate.baseline import first_or_tied, gap_of
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
    return bool(gap["causes"]) and name in first_or_tied(gap)


def diagnosis_of(effect: str, folder: Path, seed: int) -> dict[str, Any]:
    """`gap.json` of simulated sessions with an effect, or with none; an interrupted run goes on."""
    if not (folder / "report" / "gap.json").exists():
        options = ["--effect", effect] if effect else []
        sessions = ["--sessions", str(SESSIONS), "--minutes", str(MINUTES), "--profile", PROFILE, "--seed", str(seed)]
        simulated, report = folder / "sessions", folder / "report"
        _run("simulate", "--out", simulated, "--force", *sessions, *options)
        _run("diagnose", simulated, "--out", report, "--jobs", "1")
    return gap_of(folder / "report")


def _run(*words: str | Path) -> None:
    run_gyrodrift(*words, "--quiet", timeout_s=TIMEOUT_S)
