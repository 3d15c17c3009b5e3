"""A password of a config or a command line, looked for in everything that a service writes, shows and sends."""

import os
import random
import socket
import subprocess
import sys
import urllib.request
from pathlib import Path
from typing import Any

import pytest
from outputs_support import WITHOUT_BIAS, Reader, address_of, csv_at_100_hz, path_of, serving
from support import Command, never

from gyrodrift.cli import main
from gyrodrift.config.model import load_config
from gyrodrift.session.mcap.write import McapWriter
from gyrodrift.values.errors import GyrodriftError
from gyrodrift.values.sample import Sample

MARKER = "Marker7"


def config_text(password: str = f"password: {MARKER}") -> str:
    """A config with a broker, a page and lines, and the password in a comment too."""
    outputs = f"outputs:\n  - {{name: mqtt, port: 1, user: ann, {password}}}\n  - {{name: tcp, port: 0}}\n"
    return f"{WITHOUT_BIAS}# {MARKER}\n{outputs}"


MISTAKES = (
    "password: 77777",
    f"password: [{MARKER}]",
    f"pasword: {MARKER}",
    f"password:{MARKER}",
    f"password={MARKER}",
    f"password: *{MARKER}",
    f"password: !{MARKER}!x {MARKER}",
    f"password: &{MARKER} 5, user: &{MARKER} x",
    f"password: '{MARKER}",
    f"password: {MARKER}, password: {MARKER}",
    f"password: {MARKER * 1000}",
    f"host: 'ann:{MARKER}@127.0.0.1'",
    f"host: 'mqtt://ann:{MARKER}@127.0.0.1'",
)


def requested(path: Path, line: str) -> bytes:
    """The answer of a control socket as it comes."""
    with socket.socket(socket.AF_UNIX) as connection:
        connection.connect(str(path))
        connection.sendall(line.encode() + b"\n")
        return Reader(connection).line()


def command_lines(pid: int) -> bytes:
    children = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    return b"".join(command_line(item) for item in (pid, *map(int, children)))


def command_line(pid: int) -> bytes:
    """Nothing of a child that has ended meanwhile."""
    try:
        return Path(f"/proc/{pid}/cmdline").read_bytes()
    except (FileNotFoundError, ProcessLookupError):
        return b""


def fed(serve: Command, device: Any, first: int) -> None:
    """Another 50 samples, all the way through."""
    device.send_all(csv_at_100_hz(50, first=first), never)
    serve.take_lines(50)


@pytest.fixture
def run_with_a_secret(port: Path, tmp_path: Path) -> tuple[Path, bytes]:
    """A folder with recordings, and all that a service said meanwhile."""
    config, control, out = tmp_path / "c.yaml", tmp_path / "control", tmp_path / "sessions"
    config.write_text(config_text())
    config.chmod(0o600)
    output = f"mqtt:port=1,user=bob,password={MARKER},x"
    options: tuple[str | Path, ...] = (
        "--config",
        config,
        "--control",
        control,
        "--record",
        out,
        "--log-level",
        "debug",
        "--protocol",
        "csv",
    )
    statement = b""
    options += ("--output", output.removesuffix(",x"), "--output", "web:port=0")
    with serving(port, *options, is_fresh=True) as (serve, device):
        fed(serve, device, 0)
        statement += command_lines(serve.process.pid)
        statement += urllib.request.urlopen(path_of(serve, "web")).read()
        with socket.create_connection(address_of(serve, "tcp")) as client:
            reader = Reader(client)
            statement += reader.line()
            for number, mistake in enumerate(MISTAKES[::6]):
                config.write_text(config_text(mistake))
                answer = requested(control, "reload")
                assert b'"ok": false' in answer, mistake
                statement += answer + requested(control, "status")
                fed(serve, device, 50 * number + 50)
            config.write_text(config_text(f"password: {MARKER}2"))
            statement += requested(control, "reload") + requested(control, "status") + reader.line()
        serve.until_log("output_failed")
        assert serve.stop() == 0
        statement += serve.log.encode() + serve.out.encode()
    return out, statement


@pytest.mark.promise(
    "Secrets",
    "a password of the config or of `--output` appears in no recording, log, message, status, page or process list",
)
@pytest.mark.promise("Secrets")
def test_a_password_is_nowhere(run_with_a_secret: tuple[Path, bytes], tmp_path: Path) -> None:
    """Only users who may read the config may read a recording of it."""
    out, statement = run_with_a_secret
    assert b"password=***" in statement
    assert (MARKER.encode() in statement, b"77777" in statement) == (False, False)
    (recording,) = out.glob("*.mcap")
    assert recording.stat().st_mode & 0o777 == 0o600
    assert MARKER.encode() not in recording.read_bytes()
    assert b'password: "***"' in recording.read_bytes()


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_in_a_config_does_not_quote_the_password(mistake: str, tmp_path: Path) -> None:
    config = tmp_path / "c.yaml"
    config.write_text(config_text(mistake))
    with pytest.raises(GyrodriftError) as raised:
        load_config(config)
    assert MARKER not in str(raised.value)
    assert "77777" not in str(raised.value)


MISTAKEN_WORDS = (
    f"mqtt:pasword={MARKER}",
    f"mqtt:password=a,{MARKER}",
    f"mqtt:port=x,password={MARKER}",
    f"mqqt:password={MARKER}",
    f"mqtt:password:{MARKER}",
    f"mqtt:password=a,{MARKER}=b",
    f"mqtt,password={MARKER}",
    f"mqtt:host=ann:{MARKER}@127.0.0.1",
    f"tcp:host=tcp://ann:a,{MARKER}@127.0.0.1",
    f"mqtt:host=ann:{MARKER},@127.0.0.1",
)


@pytest.mark.promise("Secrets")
@pytest.mark.promise("Secrets", "a host with a password in it (`user:password@host`) is refused, and not quoted")
@pytest.mark.parametrize("argument", MISTAKEN_WORDS)
def test_a_mistake_on_the_command_line_does_not_quote_the_password(
    argument: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """A mistake on the command line is reported without the password."""
    for option in ("--output", "--outptu"):
        assert main(["serve", "--port", "/dev/null", option, argument]) == 2
        statement = "".join(capsys.readouterr())
        assert statement
        assert MARKER not in statement


def test_a_config_that_is_a_password_file_is_not_quoted(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Two options are easily mixed up."""
    (tmp_path / "p").write_text(f"{MARKER}\n")
    assert main(["serve", "--port", "/dev/null", "--config", str(tmp_path / "p")]) == 2
    statement = "".join(capsys.readouterr())
    assert statement
    assert MARKER not in statement


def old_recording(path: Path) -> None:
    """A recording of a version that kept the config as it was."""
    with path.open("wb") as file:
        writer = McapWriter(file, {"config": {"file": "c.yaml", "text": config_text()}})
        writer.add_all([Sample(i, i / 100, 1.7e9 + i / 100, 1.0) for i in range(100)])
        writer.flush()


@pytest.mark.promise("Secrets")
def test_what_a_repair_cuts_off_is_kept_without_passwords(tmp_path: Path) -> None:
    """The file that `repair` cuts off has no passwords, and the mode of the recording."""
    path = tmp_path / "old.mcap"
    with path.open("wb") as file:
        writer = McapWriter(file, {})
        writer.add_all([Sample(i, i / 100, 1.7e9 + i / 100, 1.0) for i in range(100)])
        writer.flush()
    samples = random.Random(1).randbytes(1 << 16).replace(b"\0", b"\1")  # one in a hundred mentions "pwd" by chance
    with path.open("ab") as file:
        file.write(b"\0" * 8 + b"\xff" * 9 + config_text().encode() + b"\0" + samples + b"\0" + samples)
    path.chmod(0o640)
    run = subprocess.run([sys.executable, "-m", "gyrodrift", "repair", path], capture_output=True, check=True)
    (tail,) = tmp_path.glob("*.tail*")
    assert str(tail) in run.stdout.decode()
    assert tail.stat().st_mode & 0o777 == 0o640
    assert MARKER.encode() not in tail.read_bytes()
    assert tail.read_bytes().count(samples) == 2


@pytest.mark.promise("Secrets")
def test_an_old_recording_that_holds_a_password_gives_it_to_nobody(
    tmp_path: Path, capfdbinary: pytest.CaptureFixture[bytes]
) -> None:
    """A password in an older recording is neither shown nor copied."""
    old, repaired = tmp_path / "old.mcap", tmp_path / "repaired.mcap"
    old_recording(old)
    old_recording(repaired)
    assert MARKER.encode() in old.read_bytes()
    for words in (
        ("info", old),
        ("info", "--json", old),
        ("info", old, "--out", tmp_path / "page"),
        ("convert", old, tmp_path / "new.mcap"),
        ("convert", old, tmp_path / "imu.mcap", "--as", "imu"),
        ("convert", old, tmp_path / "new.csv"),
        ("repair", repaired),
        ("filter", old, "--out", tmp_path / "yaw.csv"),
        ("doctor", old),
    ):
        main([str(word) for word in words])
    statement = b"".join(capfdbinary.readouterr())
    made = [Path(position, name) for position, _, names in os.walk(tmp_path) for name in names]
    assert MARKER.encode() not in statement
    assert b"password" in statement
    assert {path for path in made if MARKER.encode() in path.read_bytes()} <= {old, repaired}
    assert {"new.mcap", "imu.mcap", "new.csv", "report.html", "yaw.csv"} <= {path.name for path in made}
