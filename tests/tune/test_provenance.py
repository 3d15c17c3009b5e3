"""Provenance of the parameters of a config, however much of it a person has rewritten."""

from pathlib import Path

import pytest

from gyrodrift.compare.tuning import TunedSession, TuningProvenance, read_provenance
from gyrodrift.evaluation.dataset import Split

ROOT = Path(__file__).parents[2]
SESSIONS = "sessions: [{name: a, split: train, sha256: ab}, {name: b, split: test, sha256: cd}]"


def read(folder: Path, content: str) -> TuningProvenance | None:
    path = folder / "c.yaml"
    path.write_text(content)
    return read_provenance(path)


def test_sessions_come_with_what_they_were_used_for(tmp_path: Path) -> None:
    """The filter is the one that the block names, or else the config."""
    result = read(tmp_path, f"filter: hdr\nprovenance: {{seed: 3, iterations: 90, command: x, {SESSIONS}}}\n")
    a, b = TunedSession("a", Split.TRAIN, "ab"), TunedSession("b", Split.TEST, "cd")
    assert result == TuningProvenance("hdr", (a, b), "x", 3, 90)
    assert result.training == (a,)
    named = read(tmp_path, f"filter: hdr\nprovenance: {{filter: restlevel, {SESSIONS}}}\n")
    assert named == TuningProvenance("restlevel", (a, b))


@pytest.mark.parametrize(
    "content",
    [
        "filter: hdr\n",
        "",
        "filter: hdr\nprovenance: {by: hand, seeds: [1, 2]}\n",
        "filter: hdr\nprovenance: [1]\n",
        "filter: hdr\nprovenance: {sessions: 3}\n",
        "filter: hdr\nprovenance: {sessions: [3, {name: a}, {name: b, split: other}]}\n",
        f"provenance: {{{SESSIONS}}}\n",
    ],
)
def test_what_tells_of_no_tuning_is_none(tmp_path: Path, content: str) -> None:
    assert read(tmp_path, content) is None


def test_the_shipped_config_says_which_filter_was_tuned() -> None:
    result = read_provenance(ROOT / "config" / "gyrodrift.yaml")
    assert result is not None
    assert result.filter == "hdr"
    assert len(result.training) == 7
