"""A service that is started with standard streams closed: it runs, and no descriptor of it is another file's."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from support import PATIENCE_S, never, speaking_on

from gyrodrift.session.files import load_session

CSV = b"".join(b"%d,0.5\n" % t_us for t_us in range(0, 2_000_000, 10_000))
CLOSED = ([0], [1], [2], [1, 2], [0, 1, 2])


def started(command: list[str], closed: list[int]) -> subprocess.Popen[bytes]:
    """A shell closes them, as a person would write it."""
    closing = " ".join(f"{fd}{'<' if fd == 0 else '>'}&-" for fd in closed)
    words = [sys.executable, "-m", "gyrodrift", *command]
    return subprocess.Popen(
        ["sh", "-c", f'exec "$@" {closing}', "sh", *words],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )


def recorded(folder: Path) -> bytes:
    return b"".join(path.read_bytes() for path in folder.glob("*.mcap"))


@pytest.mark.promise("Configs and commands")
@pytest.mark.parametrize("closed", CLOSED, ids=str)
@pytest.mark.parametrize("command", [["serve", "--record"], ["record", "--out"]], ids=lambda words: words[0])
def test_it_runs_as_if_they_were_the_null_device(
    port: Path, tmp_path: Path, command: list[str], closed: list[int]
) -> None:
    """With stdin, stdout or stderr closed, a command runs as with the null device."""
    folder = tmp_path / "sessions"
    with speaking_on(port) as device:
        process = started([*command, str(folder), "--port", str(port), "--protocol", "csv"], closed)
        try:
            device.wait_for_reader(never)
            device.send_all(CSV, never)
            end_s = time.monotonic() + PATIENCE_S
            while len(recorded(folder)) < 10_000 and process.poll() is None and time.monotonic() < end_s:
                time.sleep(0.05)
            assert process.poll() is None
            for fd in closed:
                assert Path(f"/proc/{process.pid}/fd/{fd}").readlink() == Path(os.devnull)
            process.send_signal(signal.SIGTERM)
            out, err = process.communicate(timeout=PATIENCE_S)
        finally:
            process.kill()
            process.wait()
    assert process.returncode == 0
    assert b"Traceback" not in err
    (path,) = folder.glob("*.mcap")
    assert len(load_session(path).rate_dps) == 200
    content = path.read_bytes()
    assert b"event=" not in content
    assert b'"yaw_deg"' not in content
    assert bool(out) == (1 not in closed)
    assert bool(err) == (2 not in closed)
