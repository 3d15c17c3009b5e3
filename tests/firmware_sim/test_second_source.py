"""Second sources of the rig: their flaws, the session with them, and the lines of the simulated device."""

from itertools import islice

import pytest

from firmware_sim.measure import measure
from firmware_sim.motion.profile import load_motion
from firmware_sim.rig import Rig, parse_aid, with_aids
from firmware_sim.second_source import AidValue, aid_streams, lines_between, until
from firmware_sim.wire.registry import ENCODERS
from firmware_sim.yaml_file import FileError
from gyrodrift.simulation.sessions import Simulation, rig_yaml

DRIVE = load_motion("drive")


def values(text: str, seconds: float = 120.0) -> list[AidValue]:
    return until(aid_streams((parse_aid(text),), DRIVE, 1), seconds)


def test_flaws_show_in_the_values() -> None:
    ideal = [it.value for it in values("turn_rate:every_s=1,sigma=0")]
    assert [it.value for it in values("turn_rate:every_s=1,sigma=0,sign=-1")] == [-value for value in ideal]
    assert values("heading:every_s=10,late_s=0.5")[3].t_s == pytest.approx(30.5)
    assert {it.value % 5.0 for it in values("heading:sigma=0,resolution=5")} == {0.0}
    assert max(it.value for it in values("heading:period_deg=90")) < 90.0
    assert len({it.value for it in values("turn_rate:stuck_s=30") if it.t_s > 31.0}) == 1
    assert len(values("speed:every_s=1,gone_share=0.5")) < 110
    assert {it.value for it in values("speed:threshold=1")} == {0.0}
    wrong = [it.value for it in values("standing:every_s=1,wrong_share=0.3")]
    assert [it.value for it in values("standing:every_s=1")] != wrong


def test_a_source_does_not_change_the_gyro_and_comes_with_its_samples() -> None:
    """A rig without second sources is written as before."""
    rig = with_aids(Rig(), [parse_aid("wheels"), parse_aid("heading:every_s=10,late_s=0.3")])
    plain, aided = (Simulation(it, DRIVE, 1, minutes=1.0).whole() for it in (Rig(), rig))
    assert (plain.rate_dps == aided.rate_dps).all()
    assert plain.aids is None
    rows = [row for row, aid in aided.aids or () if aid.name == "heading"]
    assert rows == [30, 1030, 2030, 3030, 4030, 5030]
    assert "aids" not in rig_yaml(Rig())
    assert "name: wheels" in rig_yaml(rig)


def test_the_device_sends_lines_of_its_second_sources() -> None:
    rig = with_aids(Rig(), [parse_aid("heading:every_s=0.02,sigma=0"), parse_aid("wheels:every_s=0.04")])
    frames = ENCODERS["text"].frames(measure(rig, DRIVE, 1), rig.base)
    lines = [frame.content for frame in islice(lines_between(frames, aid_streams(rig.aids, DRIVE, 1)), 12)]
    assert sum(line.startswith(b"heading:") for line in lines) > 2
    assert any(line.startswith(b"wheels_left:") and b",wheels_right:" in line for line in lines)


@pytest.mark.parametrize("text", ["headings", "heading:every=1", "heading:sign=2", "wheels:late_s=-1"])
def test_mistakes_are_told(text: str) -> None:
    with pytest.raises(FileError, match="--aid"):
        parse_aid(text)
