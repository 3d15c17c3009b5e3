"""Damaged recordings on the command line: status 4 with what is lost, or on with what is whole when it is asked for."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader

from gyrodrift import load_session
from gyrodrift.cli import main
from gyrodrift.session.damage import DamagedError
from gyrodrift.session.files import write_session
from gyrodrift.session.session import Session

COUNT = 4000
BLOCK = 4096


@pytest.fixture
def damaged(tmp_path: Path) -> Path:
    """A session with an encoder; 4 KiB in the middle of it read as zeros."""
    t_s = np.arange(COUNT) / 100.0
    rate_dps = 30.0 * np.sin(t_s)
    dice = np.random.default_rng(1)
    session = Session(
        "s",
        t_device_s=t_s,
        rate_dps=rate_dps + dice.normal(0.0, 0.1, COUNT),
        t_host_s=1.7e9 + t_s,
        seq=np.arange(COUNT),
        encoder_deg=30.0 * (1.0 - np.cos(t_s)),
    )
    path = tmp_path / "s.mcap"
    write_session(path, [session], {"device": {"device_id": "bench"}})
    content = path.read_bytes()
    position = len(content) // 2 // BLOCK * BLOCK
    path.write_bytes(content[:position] + bytes(BLOCK) + content[position + BLOCK :])
    return path


COMMANDS = {
    "info": [],
    "filter": ["--out", "{}/f.csv"],
    "convert": ["{}/c.csv"],
    "doctor": ["--fail-on", "error"],
    "compare": [],
    "tune": ["--out", "{}/t.yaml", "--iterations", "10"],
    "diagnose": ["--out", "{}/d"],
    "replay": ["--link", "{}/link", "--lsb", "0.01"],
}


@pytest.mark.promise(
    "Crashes",
    "without `--allow-damage`, every command ends with status 4 on a damaged session, and says which samples are lost",
)
@pytest.mark.parametrize("command", COMMANDS)
def test_each_command_that_reads_sessions_ends_with_status_4_and_says_what_is_lost(
    damaged: Path, command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    rest = [word.format(damaged.parent) for word in COMMANDS[command]]
    assert main([command, str(damaged), *rest]) == 4
    statement = capsys.readouterr().err
    assert "s.mcap: is damaged: lost are samples " in statement
    assert "--allow-damage" in statement
    assert [path.name for path in damaged.parent.iterdir() if path.is_file()] == ["s.mcap"]


@pytest.mark.parametrize("command", ["info", "filter", "convert"])
def test_with_allow_damage_it_goes_on_and_says_so_in_one_line(
    damaged: Path, command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    rest = [word.format(damaged.parent) for word in COMMANDS[command]]
    assert main([command, str(damaged), *rest, "--allow-damage"]) == 0
    statement = [line for line in capsys.readouterr().err.splitlines() if "damaged" in line]
    assert "lost are samples " in statement[0]
    if command == "convert":
        assert (damaged.parent / "c.csv").read_text().count("\n") > COUNT - 100


@pytest.mark.promise("Crashes")
def test_a_repair_writes_a_whole_file_and_says_what_could_not_be_recovered(
    damaged: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """`repair` writes an intact file of all recoverable samples, and keeps the damaged file."""
    before, remaining = damaged.read_bytes(), load_session(damaged, allow_damage=True)
    assert main(["repair", str(damaged)]) == 0
    assert re.search(r"repaired, [\d,]+ samples, \d+(\.\d+)? (bytes|kB|MB); lost are samples ", capsys.readouterr().out)
    assert damaged.with_name("s.mcap.damaged").read_bytes() == before
    session = load_session(damaged)
    assert session.damage is None
    assert np.array_equal(session.rate_dps, remaining.rate_dps)
    assert session.metadata["device"] == {"device_id": "bench"}
    assert int(session.metadata["repair"]["samples_lost"]) == COUNT - len(session.rate_dps)
    with damaged.open("rb") as file:
        assert len(list(make_reader(file, validate_crcs=True).iter_messages())) == len(session.rate_dps)
    assert main(["repair", str(damaged)]) == 0
    assert "is whole" in capsys.readouterr().out


def test_the_library_raises_an_error_with_the_same_facts(damaged: Path) -> None:
    with pytest.raises(DamagedError) as report:
        load_session(damaged)
    ((path, damage),) = report.value.damages
    session = load_session(damaged, allow_damage=True)
    assert (path, damage) == (damaged, session.damage)
    assert damage.kept == len(session.rate_dps) == COUNT - damage.lost_count
    assert damage.lost_seconds == pytest.approx(damage.lost_count / 100.0)
    assert session.seq is not None
    missing = np.setdiff1d(np.arange(COUNT), session.seq)
    assert damage.lost[0].first == missing[0]
    assert damage.lost[0].t_s == pytest.approx(missing[0] / 100.0)


def test_info_as_json_has_no_damage_where_there_is_none(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "whole.mcap"
    write_session(path, [Session("s", np.arange(100) / 100.0, np.ones(100))])
    assert main(["info", "--json", str(path)]) == 0
    report = capsys.readouterr()
    assert json.loads(report.out)["samples"] == 100
    assert "damaged" not in report.err
