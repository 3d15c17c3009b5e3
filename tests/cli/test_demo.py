"""`gyrodrift demo`: a simulated device, a real service, and the yaw error against the encoder."""

import os
import pty
import re
import select
import subprocess
import sys
from pathlib import Path

from support import PATIENCE_S, Command


def test_without_a_terminal_it_prints_the_summary(tmp_path: Path) -> None:
    """Corrected yaw is nearer to the encoder than the integrated rate, on the shipped rig and config."""
    with Command("demo", "--duration", "20", "--speed", "10", "--svg", tmp_path / "demo.svg") as demo:
        assert demo.end() == 0
    errors = [float(text) for text in re.findall(r"mean \|error\| +([0-9.]+) deg", demo.out)]
    assert len(errors) == 2
    raw_deg, corrected_deg = errors
    assert 1.0 < raw_deg < 10.0
    assert corrected_deg < 0.5 * raw_deg
    assert "<svg" in (tmp_path / "demo.svg").read_text()


def test_on_a_terminal_it_is_live() -> None:
    """The view is drawn again and again, and the summary stands at the end."""
    master, slave = pty.openpty()
    command = [sys.executable, "-m", "gyrodrift", "demo", "--duration", "10", "--speed", "10"]
    environment = os.environ | {"TERM": "xterm-256color", "COLUMNS": "120", "LINES": "40"}
    process = subprocess.Popen(command, stdout=slave, stderr=slave, stdin=slave, env=environment)
    os.close(slave)
    shown = b""
    while select.select([master], [], [], PATIENCE_S)[0]:
        try:
            shown += os.read(master, 1 << 16)
        except OSError:
            break
    os.close(master)
    assert process.wait(PATIENCE_S) == 0
    assert shown.count(b"table (encoder)") >= 3
    assert b"raw integration" in shown.splitlines()[-2]


def test_a_bad_profile_is_told_and_ends_it() -> None:
    """With the words of the simulator and the status of a broken link."""
    with Command("demo", "--profile", "nowhere") as demo:
        assert demo.end() == 3
    assert "nowhere: there is no such profile; shipped are " in demo.log
    assert "Traceback" not in demo.log
