"""`serve --memory`: what is kept across restarts, whose it is, and what becomes of a file that is damaged."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from outputs_support import serving
from support import PATIENCE_S, Command, never, speaking_on

from gyrodrift.service.memory_file import CLOCK_UNSET_S, MemoryDamagedError, MemoryFile, read_memory

RESTING, MOVING = 2000, 500


def lines(first: int, true_dps: np.ndarray[tuple[int], np.dtype[np.float64]]) -> bytes:
    """The csv protocol at 100 Hz, with a bias of 0.4 deg/s."""
    noise = np.random.default_rng(first).normal(0.4, 0.05, len(true_dps))
    rows = (f"{(first + n) * 10_000},{rate:.4f}\n" for n, rate in enumerate((true_dps + noise).tolist()))
    return "".join(rows).encode()


def rested(port: Path, memory: Path, *options: str | Path) -> None:
    """A run that rests for 20 s."""
    with serving(port, "--memory", memory, *options) as (serve, device):
        for index in range(0, RESTING, 500):
            device.send_all(lines(index, np.zeros(500)), never)
            serve.take_lines(500)
        assert serve.stop() == 0


def moved(port: Path, *options: str | Path) -> tuple[list[dict[str, Any]], str]:
    """The lines of a run that begins moving, and its log."""
    with serving(port, *options) as (serve, device):
        device.send_all(lines(0, 40.0 * np.sin(np.arange(MOVING) / 50.0)), never)
        result = serve.take_lines(MOVING)
        assert serve.stop() == 0
        return result, serve.log


def test_a_restart_in_motion_knows_the_bias_and_its_recording_gives_the_same_bits(port: Path, tmp_path: Path) -> None:
    """`filter` on the recording, and `replay` with `serve --memory RECORDING`."""
    memory, folder = tmp_path / "m.json", tmp_path / "r"
    rested(port, memory)
    content = json.loads(memory.read_text())
    assert (content["gyrodrift_memory"], content["device"], content["filter"]) == (1, str(port), "restlevel")
    assert content["knowledge"]["bias_dps"] == pytest.approx(0.4, abs=0.01)
    result, log = moved(port, "--memory", memory, "--record", folder)
    assert '"event": "memory_used"' in log
    assert result[0]["bias_dps"] == pytest.approx(0.4, abs=0.01)
    assert result[0]["bias_sigma_dps"] < 0.1
    (recording,) = folder.glob("*.mcap")
    with Command("filter", recording) as filtered:
        assert filtered.end() == 0
    header, *rows = (row.split(",") for row in filtered.out.splitlines())
    yaws_deg = [float(row[header.index("yaw_deg")]) for row in rows]
    assert [round(yaw_deg, 4) for yaw_deg in yaws_deg] == [line["yaw_deg"] for line in result]
    link = tmp_path / "again"
    with Command("replay", recording, "--link", link, "--speed", "max") as replay:
        replay.until_log("waiting for a reader")
        with Command("serve", "--port", link, "--memory", recording) as serve:
            again = serve.take_lines(MOVING)
            serve.stop()
    assert [line["yaw_deg"] for line in again] == [line["yaw_deg"] for line in result]


def test_a_memory_goes_on_where_a_run_learns_nothing(port: Path, tmp_path: Path) -> None:
    memory = tmp_path / "m.json"
    rested(port, memory)
    before = memory.read_bytes()
    moved(port, "--memory", memory)
    assert memory.read_bytes() == before


@pytest.mark.parametrize(
    ("key", "second", "statement"),
    [
        ("device", "bench-8", "it is for device bench-8, and this is "),
        ("filter", "hdr", "it is for the filter hdr, and restlevel runs"),
    ],
)
def test_a_memory_of_something_else_is_refused_and_left_alone(
    port: Path, tmp_path: Path, key: str, second: str, statement: str
) -> None:
    memory = tmp_path / "m.json"
    rested(port, memory)
    memory.write_text(json.dumps(json.loads(memory.read_text()) | {key: second}))
    before = memory.read_bytes()
    rested(port, memory)
    result, log = moved(port, "--memory", memory)
    assert '"event": "memory_refused"' in log
    assert statement in log
    assert result[0]["bias_dps"] == 0.0
    assert memory.read_bytes() == before


def test_a_memory_under_another_calibration_is_begun_anew(port: Path, tmp_path: Path) -> None:
    memory, config = tmp_path / "m.json", tmp_path / "c.yaml"
    rested(port, memory)
    config.write_text("filter: restlevel\ncalibration: {date: '2026-11-01T12:00:00Z', bias_dps: 0.4}\n")
    result, log = moved(port, "--memory", memory, "--config", config)
    assert '"reason": "the calibration has changed, and with it the bias"' in log
    assert result[0]["bias_dps"] == 0.0
    rested(port, memory, "--config", config)
    content = json.loads(memory.read_text())
    assert content["calibration"] == "2026-11-01T12:00:00Z"
    assert content["knowledge"]["bias_dps"] == pytest.approx(0.0, abs=0.01)
    result, log = moved(port, "--memory", memory, "--config", config)
    assert '"event": "memory_used"' in log


@pytest.mark.parametrize("damage", [b"", b"\xff\xfe", b'{"gyrodrift_memory": 1}', b"[1, 2", None])
def test_a_damaged_memory_is_told_set_aside_and_begun_anew(port: Path, tmp_path: Path, damage: bytes | None) -> None:
    memory = tmp_path / "m.json"
    rested(port, memory)
    if damage is None:
        content = json.loads(memory.read_text())
        content["knowledge"]["bias_dps"] = "much"
        damage = json.dumps(content).encode()
    memory.write_bytes(damage)
    with serving(port, "--memory", memory) as (serve, device):
        device.send_all(lines(0, np.zeros(500)), never)
        assert serve.take_lines(500)[0]["bias_dps"] == 0.0
        serve.stop()
    assert '"event": "memory_damaged"' in serve.log
    assert (tmp_path / "m.json.damaged_1").read_bytes() == damage
    assert not memory.exists()


def test_a_memory_of_the_future_is_a_day_old() -> None:
    """The clock of one of the two runs was not set: nobody knows how old it is."""
    memory = MemoryFile("bench-7", "restlevel", 2000.0, {})
    assert memory.age_s(2500.0) == 500.0
    assert memory.age_s(1999.0) == CLOCK_UNSET_S


@pytest.mark.parametrize("written", ["1" + "0" * 400, "NaN", "1e999", "-1e999"])
def test_a_memory_was_made_at_a_time(tmp_path: Path, written: str) -> None:
    """JSON has numbers that are none, or that no float holds."""
    memory = tmp_path / "m.json"
    memory.write_text(
        f'{{"gyrodrift_memory": 1, "device": "", "filter": "restlevel", "written_s": {written}, "knowledge": {{}}}}'
    )
    with pytest.raises(MemoryDamagedError, match="written_s is no time"):
        read_memory(memory)


def test_where_nothing_can_be_written_it_is_said_at_once(port: Path, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with Command("serve", "--port", "/dev/null", "--memory", tmp_path / "file" / "m.json") as serve:
        assert serve.end() != 0
    assert "Traceback" not in serve.log


HANGS = """
import os, sys, time
from gyrodrift.cli import main
from gyrodrift.service import memory_keeper
memory_keeper.HANGS_S = 0.2
os.fsync = lambda fd: time.sleep(1e6)
sys.exit(main(sys.argv[1:]))
"""


@pytest.mark.promise("Memory and the end")
def test_a_disk_that_hangs_does_not_hold_up_the_end(port: Path, tmp_path: Path) -> None:
    """A disk that hangs under the memory file does not delay the end."""
    memory = tmp_path / "m.json"
    rested(port, memory)
    before = memory.read_bytes()
    with speaking_on(port) as device:
        words = [sys.executable, "-c", HANGS, "serve", "--port", str(port), "--memory", str(memory)]
        serve = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        device.wait_for_reader(never)
        assert serve.stdout is not None
        for index in range(0, RESTING, 500):
            device.send_all(lines(index, np.zeros(500)), never)
            for _ in range(500):
                serve.stdout.readline()
        serve.terminate()
        _, log = serve.communicate(timeout=PATIENCE_S)
    assert serve.returncode == 0
    assert f"{memory}: the disk hangs" in log
    assert memory.read_bytes() == before


def test_the_status_tells_of_the_memory(port: Path, tmp_path: Path) -> None:
    memory, control = tmp_path / "m.json", tmp_path / "control"
    with serving(port, "--memory", memory, "--control", control) as (serve, device):
        device.send_all(lines(0, np.zeros(100)), never)
        serve.take_lines(100)
        with Command("ctl", control, "status") as request:
            request.end()
        serve.stop()
    report = json.loads(request.out)["memory"]
    assert report == {"file": str(memory), "state": "new", "reason": "", "device": str(port)}
