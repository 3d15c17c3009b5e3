"""Figures of the simulators' part on cases in Drake and pymunk (simulators/unseen), one session set of each."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from simulators.unseen.benches import BENCHES
from simulators.unseen.cases import BOTH_SIDES, CASES, REAL, SIMULATOR
from simulators.unseen.sessions import write_set

from evaluate.baseline import diagnose, gap_of, is_sure_and_wrong, names_group, words_of
from evaluate.figures import Figure, share_figure

Say = Callable[[str], None]


def unseen_figures(folder: Path, say: Say) -> list[Figure]:
    """Shares of right verdicts over the cases whose simulator is installed; none without both simulators."""
    numbers = installed_numbers(say)
    done = [(CASES[number - 1].effect, diagnosed(number, folder, say)) for number in numbers]
    hits = {
        "no gap: none": [gap["verdict"] == "none" for effect, gap in done if not effect],
        "group named first": [names_group(effect, gap) for effect, gap in done if effect],
        "no cause above 0.8 that is not there": [not is_sure_and_wrong(effect, gap) for effect, gap in done],
    }
    return [share_figure(f"Drake and pymunk, {name}", sum(of), len(of)) for name, of in hits.items() if of]


def installed_numbers(say: Say) -> list[int]:
    """Cases that can be simulated; says which package the others need."""
    missing = sorted({bench.package for bench in BENCHES.values() if not bench.is_installed()})
    numbers = [number for number, case in enumerate(CASES, 1) if BENCHES[case.bench].package not in missing]
    if missing:
        say(f"left out: {len(CASES) - len(numbers)} unseen cases in {', '.join(missing)}; pip install pymunk drake")
    return numbers


def diagnosed(number: int, folder: Path, say: Say) -> dict[str, Any]:
    """`gap.json` of a case; an interrupted evaluation continues."""
    case, own = CASES[number - 1], folder / f"unseen_{number:03d}"
    if not (own / "out" / "gap.json").exists():
        for side in BOTH_SIDES:
            if not (own / side).exists():
                write_set(own / side, number, side)
        diagnose(own / REAL, own / SIMULATOR, own / "out")
    gap = gap_of(own / "out")
    say(f"unseen {number}, {case.bench}, {case.effect or 'nothing'} ({case.size}): {words_of(gap)}")
    return gap
