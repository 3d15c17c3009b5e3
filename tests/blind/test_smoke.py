"""A handful of blind cases, and six rigs against themselves, through the real program."""

import subprocess
import sys
from pathlib import Path

import pytest

from blind.command import main
from blind.folder import SetFolder
from blind.score import is_right
from blind.tried import open_all

PATIENCE = ("--timeout", "3000")
"""A run that takes longer has failed; on a machine with much else to do, ten minutes are not enough to tell."""

LEAST_RIGHT = 6
SIX_RIGS_SEED = 6
MOST_ALARMS = 1
"""At a rate of 5 % six cases give two alarms or more in 3 of 100 draws."""


def has_diagnose() -> bool:
    words = [sys.executable, "-m", "gyrodrift", "diagnose", "--help"]
    return subprocess.run(words, capture_output=True, check=False).returncode == 0


@pytest.mark.long
@pytest.mark.timeout(3600)
def test_six_rigs_explain_themselves(tmp_path: Path) -> None:
    """Sessions of random rigs, diagnosed against those very rigs: at most one false alarm in six short cases."""
    out = tmp_path / "bench"
    words = ["run", "--set", "bench", "--seed", str(SIX_RIGS_SEED), "--rows", "none_short", "--count", "6", *PATIENCE]
    assert main([*words, "--out", str(out)]) == 0
    tried = open_all(SetFolder(out))
    assert len(tried) == 6
    alarms = [f"{case.id}: {case.about} → {case.blind.text}" for case in tried if not is_right(case)]
    assert len(alarms) <= MOST_ALARMS, "\n".join(alarms)


@pytest.mark.long
@pytest.mark.timeout(3600)
def test_a_handful_of_cases(tmp_path: Path) -> None:
    """Six of seven are right: two effects, no gap, two outside the catalogue, a pair, one left out."""
    if not has_diagnose():
        pytest.skip("this program has no command diagnose")
    out = tmp_path / "smoke"
    assert main(["run", "--set", "smoke", "--no-oracle", *PATIENCE, "--out", str(out)]) == 0
    assert main(["score", str(out)]) == 0
    tried = open_all(SetFolder(out))
    assert len(tried) == 7
    wrong = [
        f"{case.put_in} → {case.blind.text}; {case.outcomes['withheld'].text}" for case in tried if not is_right(case)
    ]
    assert len(tried) - len(wrong) >= LEAST_RIGHT, "\n".join(wrong)
