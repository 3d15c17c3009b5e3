"""Other simulators: `diagnose --baseline` between sessions of MuJoCo or Bullet, and exports back in the simulator."""

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from simulators.benches import is_installed
from simulators.cases import CASES, LOOPED, SimulatorCase
from simulators.sessions import write_again, write_set

from evaluate.baseline import diagnose, first_or_tied, gap_of, is_sure_and_wrong, names_group, words_of
from evaluate.figures import Figure, share_figure
from evaluate.unseen_cases import unseen_figures

OF_SIMULATOR = 10_000
"""Seeds of the simulator's side begin here: its motions are others."""

Say = Callable[[str], None]


def measure(seed: int, count: int, folder: Path, say: Say) -> list[Figure]:
    """Shares of right verdicts; `count` seeds of each case, and the unseen cases once."""
    seeds = range(seed, seed + count)
    names = [name for name, case in CASES.items() if is_installed(case.bench)]
    if len(names) < len(CASES):
        say(f"left out: {', '.join(CASES.keys() - set(names))}; pip install '.[simulators]'")
    done = [(name, number, diagnosed(name, number, folder, say)) for name in names for number in seeds]
    nulls = [gap["verdict"] == "none" for name, _, gap in done if not CASES[name].effect]
    flawed = [(CASES[name].effect, gap) for name, _, gap in done if CASES[name].effect]
    sure = [not is_sure_and_wrong(CASES[name].effect, gap) for name, _, gap in done]
    loops = [looped(name, number, folder, say) for name in LOOPED if name in names for number in seeds]
    return [
        _share("no gap: none", nulls),
        _share("group named first", [names_group(effect, gap) for effect, gap in flawed]),
        _share("effect named first or tied with the first", [effect in first_or_tied(gap) for effect, gap in flawed]),
        _share("no cause above 0.8 that is not there", sure),
        _share("export, simulate again, diagnose: none", loops),
        *unseen_figures(folder, say),
    ]


def _share(name: str, hits: Sequence[bool]) -> Figure:
    return share_figure(name, sum(hits), len(hits))


def diagnosed(name: str, seed: int, folder: Path, say: Say) -> dict[str, Any]:
    """`gap.json` of a case; an interrupted evaluation continues."""
    case, own = CASES[name], folder / f"{name.replace(' ', '_').replace(',', '')}_{seed}"
    if not (own / "out" / "gap.json").exists():
        _write(own / "real", lambda path: write_real(path, case, seed))
        _write(own / "simulator", lambda path: write_simulator(path, case, seed))
        diagnose(own / "real", own / "simulator", own / "out")
    gap = gap_of(own / "out")
    say(f"{name}: {words_of(gap)}")
    return gap


def looped(name: str, seed: int, folder: Path, say: Say) -> bool:
    """Whether the simulator with the exported effects shows no gap to the same recordings."""
    case, own = CASES[name], folder / f"{name.replace(' ', '_').replace(',', '')}_{seed}"
    if not (own / "again" / "gap.json").exists():
        exported = json.loads((own / "out" / "export" / "effects.json").read_text())
        entries = [*exported["effects"], *exported["noise"]]
        _write(own / "simulator_again", lambda path: write_again(path, case, seed + OF_SIMULATOR, entries))
        diagnose(own / "real", own / "simulator_again", own / "again")
    gap = gap_of(own / "again")
    say(f"{name}, simulated again: {words_of(gap)}")
    return bool(gap["verdict"] == "none")


def write_real(path: Path, case: SimulatorCase, seed: int) -> None:
    """Sessions with the flaw."""
    write_set(path, case, seed, has_flaws=True)


def write_simulator(path: Path, case: SimulatorCase, seed: int) -> None:
    """Sessions of the simulator as it is."""
    write_set(path, case, seed + OF_SIMULATOR, has_flaws=False)


def _write(path: Path, write: Callable[[Path], None]) -> None:
    if not path.exists():
        write(path)
