"""The runner, with a stand-in for the program: what it hands over, what it keeps, and that a failure is a result."""

import json
import sys
from pathlib import Path
from typing import Any

import pytest
from blind.folder import SetFolder
from blind.prepare import prepare
from blind.rows.recordings import devices
from blind.run import Options, run_set
from blind.tried import open_all
from gyrogap.catalogue import EFFECTS
from gyrogap.seals import OPENINGS

EVALUATION = pytest.mark.evaluation

STAND_IN = """
import json, os, sys, time
from pathlib import Path
words = sys.argv[1:]
sessions, rig, out = (Path(words[at]) for at in (1, 3, 5))
files = sorted(str(p.relative_to(rig.parent)) for p in rig.parent.rglob("*"))
seen = {{"words": words, "rig": rig.read_text(), "files": files}}
Path({log!r}).open("a").write(json.dumps(seen) + "\\n")
{act}
out.mkdir()
(out / "gap.json").write_text(json.dumps({{"verdict": "none", "causes": [], "where": [], "leftover": [], "gap": {{}}}}))
"""


NAMES_A_CAUSE = """
out.mkdir()
(out / "rig.yaml").write_text(rig.read_text() + "# adopted")
cause = {"effect": "latency", "group": "lag", "probability": 0.9, "parameters": {}, "tied_with": []}
said = {"verdict": "effect", "causes": [cause], "where": [], "leftover": [], "gap": {}}
(out / "gap.json").write_text(json.dumps(said))
sys.exit(0)
"""


class Set:
    """A small set and a stand-in that does something before it answers."""

    def __init__(self, tmp_path: Path, row: str) -> None:
        self.folder = SetFolder(tmp_path / "set")
        self.log = tmp_path / "log"
        self._script = tmp_path / "stand_in.py"
        prepare(self.folder, 9, [row], 1)

    def run(self, act: str = "", timeout_s: float = 60.0, *, oracle: bool = False, keep: bool = False) -> None:
        self._script.write_text(STAND_IN.format(log=str(self.log), act=act))
        command = (sys.executable, str(self._script))
        options = Options(workers=1, timeout_s=timeout_s, oracle=oracle, keep=keep, command=command)
        run_set(self.folder, options, print)

    def calls(self) -> list[dict[str, Any]]:
        return [json.loads(line) for line in self.log.read_text().splitlines()] if self.log.exists() else []

    def result(self, run: str = "blind") -> dict[str, Any]:
        case = self.folder.plan().cases[0].name
        read: dict[str, Any] = json.loads(self.folder.result(case, run).read_text())
        return read


def test_it_hands_over_sessions_and_a_rig_alone(tmp_path: Path) -> None:
    """The words of the command line, and nothing else beside the sessions; no seal is opened."""
    item = Set(tmp_path, "triple")
    item.run()
    (call,) = item.calls()
    words = call["words"]
    assert [words[0], words[2], words[4], *words[6:]] == ["diagnose", "--rig", "--out", "--jobs", "1"]
    assert call["files"] == ["rig.yaml", "sessions", *(f"sessions/session-{number}.csv" for number in range(1, 4))]
    assert not [effect for effect in EFFECTS if effect in " ".join(words)]
    assert not Path(words[1]).exists()
    assert not (item.folder.root / OPENINGS).exists()
    assert item.result()["gap"]["verdict"] == "none"


@pytest.mark.evaluation
def test_what_the_plan_withholds_is_withheld_in_a_second_run(tmp_path: Path) -> None:
    item = Set(tmp_path, "left_out")
    item.run()
    assert [call["words"][8:] for call in item.calls()] == [[], ["--withhold", "scale_factor"]]
    assert item.result()["data_sha256"] == item.result("withheld")["data_sha256"]


@pytest.mark.evaluation
def test_what_has_a_result_is_not_run_again(tmp_path: Path) -> None:
    """A run that was interrupted goes on; the sessions are kept where that is asked for."""
    item = Set(tmp_path, "triple")
    item.run(keep=True)
    item.run()
    assert len(item.calls()) == 1
    assert (item.folder.kept(item.folder.plan().cases[0].name) / "rig.yaml").is_file()


@pytest.mark.evaluation
def test_the_oracle_may_name_the_true_effect_only(tmp_path: Path) -> None:
    item = Set(tmp_path, "single")
    item.run(oracle=True)
    withheld = set(item.calls()[-1]["words"][8:]) - {"--withhold"}
    assert withheld == set(EFFECTS) - {"scale_factor"}
    assert (item.folder.root / OPENINGS).read_text().endswith("oracle\n")


@pytest.mark.evaluation
def test_new_sessions_are_looked_at_with_the_rig_that_was_adopted(tmp_path: Path) -> None:
    item = Set(tmp_path, "loop")
    item.run(NAMES_A_CAUSE)
    first, again = item.calls()
    assert again["rig"] == first["rig"] + "# adopted"
    assert [Path(call["words"][1]).name for call in (first, again)] == ["sessions", "again"]
    again_path = item.folder.result(item.folder.plan().cases[0].name, "again")
    again_path.unlink()
    item.run(NAMES_A_CAUSE)
    assert len(item.calls()) == 3
    assert item.calls()[2]["rig"] == again["rig"]


@pytest.mark.evaluation
def test_where_nothing_is_named_nothing_is_adopted(tmp_path: Path) -> None:
    """The second run is not made, and not tried again."""
    item = Set(tmp_path, "loop")
    item.run()
    item.run()
    assert len(item.calls()) == 1
    (tried,) = open_all(item.folder)
    assert tried.blind.said is not None
    assert tried.outcomes["again"].said is None


@pytest.mark.evaluation
def test_the_device_without_the_effect_is_looked_at_with_the_same_rig(tmp_path: Path) -> None:
    item = Set(tmp_path, "small")
    item.run()
    first, without = item.calls()
    assert first["rig"] == without["rig"]
    assert Path(without["words"][1]).name == "without"


@pytest.mark.evaluation
def test_a_baseline_is_handed_over(tmp_path: Path) -> None:
    if not devices():
        pytest.skip("the folder of recordings is not there")
    item = Set(tmp_path, "baseline")
    item.run()
    (call,) = item.calls()
    words = call["words"]
    assert words[8] == "--baseline"
    assert [Path(words[index]).name for index in (1, 9)] == ["sessions", "baseline"]
    assert {name.split("/")[0] for name in call["files"]} == {"rig.yaml", "sessions", "baseline"}


@pytest.mark.parametrize(
    ("act", "failure"),
    [
        ("sys.exit('it broke')", "exit status 1"),
        pytest.param("out.mkdir(); (out / 'gap.json').write_text('{'); sys.exit(0)", "gap.json", marks=EVALUATION),
        pytest.param("sys.exit(0)", "gap.json", marks=EVALUATION),
        pytest.param("time.sleep(60)", "too late", marks=EVALUATION),
    ],
    ids=["breaks", "writes nonsense", "writes nothing", "hangs"],
)
def test_a_failure_is_a_result(tmp_path: Path, act: str, failure: str) -> None:
    item = Set(tmp_path, "triple")
    item.run(act, timeout_s=2.0 if failure == "too late" else 60.0)
    item.run()
    assert len(item.calls()) <= 1  # a machine that is busy may not have started it before it is late
    (tried,) = open_all(item.folder)
    assert tried.blind.said is None
    assert failure in tried.blind.failure
    if "it broke" in act:
        assert item.result()["stderr"].strip() == "it broke"
