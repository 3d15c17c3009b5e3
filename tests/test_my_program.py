"""The page on yaw in one's own program: each of its programs runs against a simulated gyro."""

import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from browser_support import browsing
from support import PATIENCE_S, Command, free_port, python_in

PAGE = Path(__file__).parents[1] / "docs" / "my-program.md"
PIPE, TCP, LIBRARY = python_in(PAGE.name)
(HTML,) = re.findall(r"```html\n(.*?)```", PAGE.read_text(), re.DOTALL)
MOST_LINES = 12


@pytest.fixture
def gyro(port: Path) -> Iterator[Path]:
    """A simulated gyro at rest."""
    with Command("--link", port, "--profile", "rest", module="firmware_sim") as device:
        device.until(lambda _: port.exists(), "port")
        yield port


def first_line(code: str, stdin: int = subprocess.DEVNULL) -> str:
    """The first line that a program prints."""
    program = subprocess.Popen([sys.executable, "-c", code], stdin=stdin, stdout=subprocess.PIPE, text=True)
    assert program.stdout is not None
    try:
        return program.stdout.readline()
    finally:
        program.kill()
        program.wait(PATIENCE_S)
        program.stdout.close()


@pytest.mark.parametrize("code", [PIPE, TCP, LIBRARY, HTML], ids=["pipe", "tcp", "library", "page"])
def test_a_program_fits_into_twelve_lines(code: str) -> None:
    """Each program is short."""
    assert len(code.strip().splitlines()) <= MOST_LINES


def test_a_program_reads_the_pipe(gyro: Path) -> None:
    """JSON lines from `serve`."""
    serve = subprocess.Popen(
        [sys.executable, "-m", "gyrodrift", "serve", "--port", str(gyro), "--quiet"], stdout=subprocess.PIPE
    )
    assert serve.stdout is not None
    with serve.stdout:
        assert re.fullmatch(
            r"\d+\.\d\d s: yaw -?\d+\.\d ± \d+\.\d deg\n", first_line(PIPE, stdin=serve.stdout.fileno())
        )
    assert serve.wait(PATIENCE_S) == 0


def test_a_program_reads_tcp(gyro: Path) -> None:
    """Lines of the output tcp."""
    port = free_port()
    with Command("serve", "--port", gyro, "--rate", "1", "--output", f"tcp:port={port}") as serve:
        serve.until_log("event=output_open")
        assert re.fullmatch(r"\d+\.\d\d s: yaw -?\d+\.\d deg\n", first_line(TCP.replace("7117", str(port))))


def test_a_program_uses_the_library(gyro: Path) -> None:
    """A gyro without a service."""
    assert abs(float(first_line(LIBRARY.replace("/dev/ttyUSB0", str(gyro))))) < 1.0


def test_a_page_shows_yaw(gyro: Path, tmp_path: Path) -> None:
    """A page that is opened as a file, with rosbridge."""
    port = free_port()
    (tmp_path / "yaw.html").write_text(HTML.replace("9090", str(port)))
    with Command("serve", "--port", gyro, "--rate", "1", "--output", f"rosbridge:port={port}") as serve:
        serve.until_log("event=output_open")
        with browsing(tmp_path / "browser") as tab:
            tab.open((tmp_path / "yaw.html").as_uri())
            tab.until("document.getElementById('yaw').textContent.endsWith('°')")
            assert tab.run("/^yaw -?[0-9.]+°$/.test(document.getElementById('yaw').textContent)")
