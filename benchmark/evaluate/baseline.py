"""`gyrodrift diagnose` beside sessions of a simulator, and whether its answer is right."""

import json
from collections.abc import Sequence
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Any

from gyrogap.answer import SURE_ABOVE

from gyrodrift.cli import main
from gyrodrift.diagnose.simulate.candidates import KINDS


def run_diagnose(words: Sequence[str]) -> None:
    """Run the command in this process, which has compiled its loops already.

    Raises
    ------
    RuntimeError
        It ended with an error.
    """
    printed = StringIO()
    with redirect_stdout(printed), redirect_stderr(printed):
        status = main(["diagnose", *words, "--jobs", "1", "--quiet"])
    if status != 0:
        raise RuntimeError(f"diagnose {' '.join(words)}: status {status}: {printed.getvalue()}")


def diagnose(real: Path, simulator: Path, out: Path) -> None:
    """Diagnose sessions beside those of a simulator, and export the effects."""
    run_diagnose([str(real), "--baseline", str(simulator), "--export", "json", "--out", str(out)])


def gap_of(out: Path) -> dict[str, Any]:
    """`gap.json` of a folder."""
    gap: dict[str, Any] = json.loads((out / "gap.json").read_text())
    return gap


def words_of(gap: dict[str, Any]) -> str:
    """Verdict and causes with their probabilities."""
    causes = [f"{cause['effect']} {cause['probability']:.2f}" for cause in gap["causes"]]
    return ", ".join([gap["verdict"], *causes])


def first_or_tied(gap: dict[str, Any]) -> set[str]:
    """The first cause and its ties; empty without causes."""
    causes = gap["causes"] or gap["negligible"]
    return {causes[0]["effect"], *causes[0]["tied_with"]} if causes else set()


def group_of(effect: str) -> str:
    """Group of effects that look alike; an effect without one is its own."""
    return KINDS[effect].group or effect


def names_group(effect: str, gap: dict[str, Any]) -> bool:
    """Whether the first cause belongs to the group of the effect."""
    causes = gap["causes"] or gap["negligible"]
    return bool(causes) and group_of(causes[0]["effect"]) == group_of(effect)


def is_sure_and_wrong(effect: str, gap: dict[str, Any]) -> bool:
    """Whether a cause outside the group of the effect has a probability above 0.8."""
    wrong = [cause for cause in gap["causes"] if not effect or group_of(cause["effect"]) != group_of(effect)]
    return any(cause["probability"] > SURE_ABOVE for cause in wrong)
