"""The library, the analyses and `serve` on a system without termios, fcntl, pty, fork, poll and unix sockets."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from support import Command, ours

from firmware_sim.effects.catalogue import CATALOGUE
from gyrodrift.cli import main

pytestmark = pytest.mark.xdist_group("portable")  # they share sessions

ELSEWHERE = "tests.portable.elsewhere"

ONE_EFFECT = [word for name in CATALOGUE if name != "scale_factor" for word in ("--withhold", name)]

COMMANDS = """
import json, sys
from gyrodrift.cli import main
statuses = {words[0]: main(words) for words in json.loads(sys.stdin.read())}
print(json.dumps(statuses), file=sys.stderr)
"""
LIBRARY = """
import sys, gyrodrift
assert all(getattr(gyrodrift, name) for name in gyrodrift.__all__)
session = gyrodrift.load_session(sys.argv[-1])
for filter_class in (gyrodrift.Hdr, gyrodrift.Restlevel):
    print(len(filter_class().update_batch(session.rate_dps, session.t_device_s).yaw_deg))
"""


def run_elsewhere(*words: str | Path, stdin: str = "") -> "subprocess.CompletedProcess[str]":
    command = [sys.executable, "-X", "warn_default_encoding", "-m", ELSEWHERE, *map(str, words)]
    return subprocess.run(command, input=stdin, capture_output=True, text=True, check=False)


@pytest.fixture(scope="module")
def slow_rig(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """20 samples a second, so that analyses take little time."""
    rig = tmp_path_factory.mktemp("rig") / "slow.yaml"
    rig.write_text("base: {sample_rate_hz: 20, noise_dps_rthz: 0.0035, bias_dps: 0.35, encoder_cpr: 36000}\n")
    return rig


@pytest.fixture(scope="module")
def sessions(slow_rig: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("portable") / "sessions"
    words = ["--out", folder, "--rig", slow_rig, "--minutes", "0.4", "--sessions", "3", "--profile", "identify"]
    assert main(["simulate", *map(str, words)]) == 0
    return folder


@pytest.mark.promise("Installation and systems")
def test_the_library_loads_and_filters_a_session(sessions: Path) -> None:
    """Without the modules that Windows lacks, the library loads and filters a session."""
    session = sessions / "session-01.mcap"
    done = run_elsewhere("-c", LIBRARY, session)
    assert (done.returncode, done.stderr) == (0, "")
    samples = [int(line) for line in done.stdout.split()]
    assert samples == [480, 480]


@pytest.mark.promise("Installation and systems")
@pytest.mark.usefixtures("diagnosis_kernels")
@pytest.mark.long
def test_analyses_run(sessions: Path, slow_rig: Path, tmp_path: Path) -> None:
    """Without these modules, `info`, `filter`, `convert`, `doctor`, `compare`, `tune` and `diagnose` run."""
    session, results = sessions / "session-01.mcap", tmp_path
    commands = [
        ["info", session],
        ["filter", session, "--out", results / "yaw.csv"],
        ["convert", session, results / "session.csv"],
        ["doctor", session],
        ["repair", session],
        ["compare", sessions, "--jobs", "1"],
        ["tune", sessions, "--jobs", "1", "--filter", "hdr", "--iterations", "30", "--out", results / "tuned.yaml"],
        ["diagnose", sessions, "--rig", slow_rig, "--jobs", "2", "--out", results / "gap", *ONE_EFFECT],
    ]
    done = run_elsewhere("-c", COMMANDS, stdin=json.dumps(commands, default=str))
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stderr.splitlines()[-1]) == {str(words[0]): 0 for words in commands}
    written = {path.name for path in results.iterdir()}
    assert {"yaw.csv", "session.csv", "tuned.yaml", "gap"} <= written


@pytest.mark.promise("Installation and systems")
def test_serve_reads_a_port_through_pyserial_alone(tmp_path: Path) -> None:
    """Without these modules, `serve` reads the port through pyserial."""
    link = tmp_path / "gyro"
    with Command("--link", link, module="firmware_sim", is_fresh=True) as device:
        device.until(lambda _: link.exists(), "link")
        with Command(
            "gyrodrift", "serve", "--port", link, "--record", tmp_path, module=ELSEWHERE, is_fresh=True
        ) as serve:
            lines = serve.take_lines(120)
            assert serve.stop() == 0
        device.stop()
    sequence = [line["seq"] for line in lines]
    assert sequence == list(range(sequence[0], sequence[0] + 120))
    assert len(list(tmp_path.glob("*.mcap"))) == 1


def test_serve_survives_an_unplugged_port(tmp_path: Path) -> None:
    """The thread that reads ends with its port, and the next port gets a thread of its own."""
    link = tmp_path / "gyro"
    with Command("--link", link, module="firmware_sim", is_fresh=True) as device:
        device.until(lambda _: link.exists(), "link")
        with Command("gyrodrift", "serve", "--port", link, module=ELSEWHERE, is_fresh=True) as serve:
            serve.take_lines(20)
            device.stop()
            serve.until_log("event=link_lost")
            with Command("--link", link, module="firmware_sim"):
                serve.until_log("event=link_restored")
                serve.take_lines(len(serve.all_lines()) - 20 + 50)
                assert serve.stop() == 0


def test_doctor_listens_to_a_port(tmp_path: Path) -> None:
    link = tmp_path / "gyro"
    with Command("--link", link, module="firmware_sim", is_fresh=True) as device:
        device.until(lambda _: link.exists(), "link")
        done = run_elsewhere("gyrodrift", "doctor", "--port", link, "--seconds", "1", "--json")
        device.stop()
    assert done.returncode == 0, done.stderr
    assert "error" not in {finding["severity"] for finding in json.loads(done.stdout)["findings"]}


@pytest.mark.promise("Installation and systems")
def test_what_needs_posix_says_so(tmp_path: Path) -> None:
    """Commands that need Linux or macOS say so there, with status 2."""
    commands = [
        ["demo"],
        ["simulated-device", "--link", str(tmp_path / "gyro")],
        ["top", "socket"],
        ["ctl", "socket", "status"],
        ["replay", "x.mcap", "--link", str(tmp_path / "gyro")],
        ["serve", "--port", "/dev/ttyNONE", "--output", "tcp"],
        ["serve", "--port", "/dev/ttyNONE", "--control", "socket"],
    ]
    done = run_elsewhere("-c", COMMANDS, stdin=json.dumps(commands))
    *sentences, statuses = done.stderr.splitlines()
    assert json.loads(statuses) == {words[0]: 2 for words in commands}
    assert all(re.match(r"gyrodrift: .* needs? Linux", line) for line in sentences)
    assert len(sentences) == len(commands)


@pytest.mark.parametrize("encoding", ["ascii", "cp1252"])
def test_an_old_encoding_of_the_terminal_stops_no_command(encoding: str) -> None:
    """A character that it lacks is shown as `?`."""
    environment = {**os.environ, "PYTHONIOENCODING": encoding}
    done = subprocess.run(ours("help", "doctor"), env=environment, capture_output=True, text=False, check=False)
    assert (done.returncode, done.stderr) == (0, b"")
    degrees = {"ascii": b"?C", "cp1252": "°C".encode("cp1252")}
    assert degrees[encoding] in done.stdout
