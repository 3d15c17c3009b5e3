"""Flaws planted into real recordings (planted.py): `diagnose --baseline` between the halves of a device."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from blind.rows.recordings import Recorded, rig_of
from gyrogap.answer import SURE_ABOVE

from evaluate.baseline import first_or_tied, gap_of, group_of, run_diagnose, words_of
from evaluate.figures import Figure, share_figure
from evaluate.planted import CASES, PlantedFlaw, halves

Say = Callable[[str], None]


def measure(_seed: int, count: int, folder: Path, say: Say) -> list[Figure]:
    """Shares over the first `count` cases whose recordings are there.

    Raises
    ------
    RuntimeError
        No recording is there.
    """
    done = [(flaw, diagnosed(flaw, folder, say)) for flaw in CASES[:count] if has_halves(flaw, say)]
    if not done:
        raise RuntimeError("there are no recordings: set GYRODRIFT_RECORDINGS to their folder")
    planted = [(flaw, gap) for flaw, gap in done if flaw.effects]
    hits = {
        "nothing changed: none": [gap["verdict"] == "none" for flaw, gap in done if not flaw.effects],
        "group of the flaw first": [names_flaw(flaw, gap) for flaw, gap in planted],
        "flaw first or tied with the first": [ties_flaw(flaw, gap) for flaw, gap in planted],
        "no cause above 0.8 of another group": [not sure_and_wrong(flaw, gap) for flaw, gap in done],
    }
    return [share_figure(name, sum(of), len(of)) for name, of in hits.items() if of]


def has_halves(flaw: PlantedFlaw, say: Say) -> bool:
    """Whether both halves have a recording; says which case is left out."""
    is_there = all(halves(flaw))
    if not is_there:
        say(f"{flaw.name}: skipped, recordings of {flaw.device} are not in the folder of further recordings")
    return is_there


def names_flaw(flaw: PlantedFlaw, gap: dict[str, Any]) -> bool:
    """Whether the first cause is of the group of the flaw."""
    causes: Sequence[dict[str, Any]] = gap["causes"] or gap["negligible"]
    return bool(causes) and group_of(causes[0]["effect"]) in _groups(flaw)


def ties_flaw(flaw: PlantedFlaw, gap: dict[str, Any]) -> bool:
    """Whether an effect of the flaw is the first cause or tied with it."""
    return not first_or_tied(gap).isdisjoint(flaw.effects)


def sure_and_wrong(flaw: PlantedFlaw, gap: dict[str, Any]) -> list[str]:
    """Causes above 0.8 of other groups."""
    sure = [cause["effect"] for cause in gap["causes"] if cause["probability"] > SURE_ABOVE]
    return [effect for effect in sure if group_of(effect) not in _groups(flaw)]


def _groups(flaw: PlantedFlaw) -> set[str]:
    return {group_of(effect) for effect in flaw.effects}


def write_case(flaw: PlantedFlaw, folder: Path) -> list[str]:
    """Write both halves and the rig; the words of the command without its output folder."""
    without, with_flaw = halves(flaw)
    Recorded(tuple(without)).write(folder / "baseline")
    Recorded(tuple(with_flaw)).write(folder / "sessions")
    (folder / "rig.yaml").write_text(rig_of(flaw.device))
    sessions, baseline, rig = (str(folder / name) for name in ("sessions", "baseline", "rig.yaml"))
    return [sessions, "--baseline", baseline, "--rig", rig]


def diagnosed(flaw: PlantedFlaw, folder: Path, say: Say) -> dict[str, Any]:
    """`gap.json` of a case; an interrupted evaluation continues."""
    own = folder / flaw.name.replace(" ", "_").replace(",", "").replace("%", "percent")
    if not (own / "out" / "gap.json").exists():
        run_diagnose([*write_case(flaw, own), "--out", str(own / "out")])
    gap = gap_of(own / "out")
    is_hit = names_flaw(flaw, gap) if flaw.effects else gap["verdict"] == "none"
    say(f"{flaw.name}, {flaw.device}: {'hit' if is_hit else 'MISS'}, {words_of(gap)}")
    return gap
