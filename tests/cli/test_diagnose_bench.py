"""The command on short sessions of any bench: wrong sizes, wrong facts, another day."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from firmware_sim.effects.catalogue import CATALOGUE
from firmware_sim.motion.profile import Profile
from firmware_sim.rig import Rig, load_rig, parse_effect, with_effects
from gyrodrift.cli import main
from gyrodrift.diagnose import diagnosis
from gyrodrift.diagnose.what_next import Next
from gyrodrift.session.files import load_session, write_session
from gyrodrift.simulation.sessions import rig_yaml, write_sessions

pytestmark = [pytest.mark.evaluation, pytest.mark.timeout(1800)]

SECONDS = 50.0
TRIED = ("scale_factor", "latency", "timestamp_jitter")
FEW = tuple(word for name in CATALOGUE if name not in TRIED for word in ("--withhold", name))
"""Few, because the choice among all effects is not what is asked here."""

MOTION = Profile.model_validate(
    {
        "about": "Of a test: rest, turns both ways at several speeds, swings.",
        "segments": [
            {"kind": "rest", "seconds": 8.0},
            {"kind": "steps", "rates_dps": [30.0, -30.0, 90.0, -90.0], "ramp_seconds": 2.0, "hold_seconds": 4.0},
            {"kind": "chirp", "seconds": 10.0, "amplitude_dps": 40.0, "from_hz": 0.2, "to_hz": 1.0},
            {"kind": "rest", "seconds": 8.0},
        ],
    }
)


@pytest.fixture(autouse=True)
def without_next_recording(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(diagnosis, "what_next", lambda *_: Next("", None))


def bench(*effects: str, **base: float) -> Rig:
    """An encoder of 4096 counts at 100 Hz, as many people have, unless it is said otherwise."""
    own = load_rig(None).base.model_copy(update={"encoder_cpr": 4096, **base})
    return with_effects(Rig(base=own), [parse_effect(text) for text in effects])


def recorded(folder: Path, rig: Rig, seed: int = 11) -> Path:
    """Three sessions."""
    list(write_sessions(rig, MOTION, folder, seed, 3, SECONDS / 60.0, "csv"))
    (folder / "rig.yaml").unlink()
    return folder


def diagnosed(sessions: Path, rig: Rig, out: Path, *options: str) -> dict[str, Any]:
    out.mkdir()
    path = out / "stated.yaml"
    path.write_text(rig_yaml(rig))
    arguments = ["--rig", str(path), "--out", str(out), "--jobs", "1", *FEW, *options]
    assert main(["diagnose", str(sessions), *arguments]) == 0
    result: dict[str, Any] = json.loads((out / "gap.json").read_text())
    return result


def test_a_wrong_size_in_the_rig_is_replaced_and_then_there_is_no_gap(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The rig says 1.2 % and the sessions 0.4; with what is adopted, new sessions show nothing."""
    gap = diagnosed(
        recorded(tmp_path / "first", bench("scale_factor:error_percent=0.4")),
        bench("scale_factor:error_percent=1.2"),
        tmp_path / "out",
    )
    (cause,) = gap["causes"]
    assert (cause["effect"], cause["in_rig"]) == ("scale_factor", {"error_percent": 1.2})
    assert cause["parameters"]["error_percent"]["value"] == pytest.approx(0.4, rel=0.2)
    assert "(scale_factor; the rig has " in capsys.readouterr().out
    rig = load_rig(tmp_path / "out" / "rig.yaml")
    (effect,) = rig.effects
    assert effect.model_dump()["error_percent"] == pytest.approx(0.4, rel=0.2)
    assert rig.base.encoder_cpr == 4096
    again = recorded(tmp_path / "second", bench("scale_factor:error_percent=0.4"), seed=12)
    after = diagnosed(again, rig, tmp_path / "again")
    assert (after["verdict"], after["causes"], after["where"]) == ("none", [], [])
    assert len(load_rig(tmp_path / "again" / "rig.yaml").effects) == 1


def test_a_wrong_fact_comes_first_and_hides_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Encoder and rate are other than the rig says; with those of the sessions the effect is found all the same."""
    sessions = recorded(tmp_path / "in", bench("scale_factor:error_percent=3"))
    gap = diagnosed(sessions, bench(encoder_cpr=36_000, dps_per_lsb=0.0305), tmp_path / "out")
    assert next(iter(gap)) == "contradictions"
    facts = {
        contradiction["fact"]: (contradiction["rig"], contradiction["sessions"])
        for contradiction in gap["contradictions"]
    }
    assert facts["encoder_cpr"] == (36_000, 4096)
    assert facts["dps_per_lsb"] == (0.0305, pytest.approx(0.00763, rel=0.01))
    statement = capsys.readouterr().out.splitlines()
    assert statement[0].startswith("contradiction of facts")
    assert all(number in statement[0] for number in ("36000", "4096"))
    assert [cause["effect"] for cause in gap["causes"]] == ["scale_factor"]
    assert load_rig(tmp_path / "out" / "rig.yaml").base.encoder_cpr == 4096


def test_beside_a_baseline_only_what_is_new_is_told(tmp_path: Path) -> None:
    """The device always had a delay that the rig lacks: the same device shows nothing, and one with 3 % more that."""
    own, rig = "latency:delay_ms=12", bench()
    before = recorded(tmp_path / "before", bench(own))
    same = recorded(tmp_path / "same", bench(own), seed=12)
    scaled = recorded(tmp_path / "scaled", bench(own, "scale_factor:error_percent=3"), seed=13)
    nothing = diagnosed(same, rig, tmp_path / "nothing", "--baseline", str(before))
    assert (nothing["verdict"], nothing["causes"]) == ("none", [])
    assert any("it already shows latency" in remark for remark in nothing["remarks"])
    changed = diagnosed(scaled, rig, tmp_path / "changed", "--baseline", str(before))
    (cause,) = changed["causes"]
    assert cause["effect"] == "scale_factor"
    assert cause["parameters"]["error_percent"]["value"] == pytest.approx(3.0, rel=0.15)


def test_seconds_that_a_host_missed_are_no_cause(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Two of them, in motion and without a counter; the gain that is off is named as if nothing were missing."""
    folder = recorded(tmp_path / "torn", bench("scale_factor:error_percent=1.2"))
    for number, path in enumerate(sorted(folder.glob("*.csv"))):
        session = replace(load_session(path), seq=None)
        begin, end = np.searchsorted(session.t_device_s, [22.0 + number, 24.0 + number]).tolist()
        write_session(path, [session.part(0, begin), session.part(end, len(session.t_device_s))])
    (cause,) = diagnosed(folder, bench(), tmp_path / "out")["causes"]
    assert cause["effect"] == "scale_factor"
    assert cause["parameters"]["error_percent"]["value"] == pytest.approx(1.2, rel=0.2)
    assert "session-02: rates or angles are missing for 2.0 s; the 2 parts of the rest" in capsys.readouterr().err
