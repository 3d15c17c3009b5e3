"""Runs the simulator and `serve`, and shows the output of `serve`."""

import io
import json
import os
import re
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import BinaryIO

from rich._export_format import CONSOLE_SVG_FORMAT
from rich.console import Console
from rich.live import Live

from gyrodrift.demo.view import PICTURE, Size, YawError, draw, summary
from gyrodrift.io.files import shipped_config, write_whole
from gyrodrift.io.terminal import is_screen
from gyrodrift.values.errors import LinkError

FRAMES_PER_S = 10
STARTING_S = 60.0
"""Longest wait for the simulator, s. A simulator that ends is noticed at once."""
SUMMARY_ROWS = 5
"""Rows for the summary and the prompt below the last view."""

DEVICE = "gyro"

ENDINGS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
"""Signals that end a demo."""

SVG_WITHOUT_WEB_FONTS = re.sub(r"@font-face \{\{.*?\}\}", "", CONSOLE_SVG_FORMAT, flags=re.DOTALL)
"""Template of the picture without web fonts: a viewer loads nothing."""


def run_demo(
    duration_s: float,
    config: Path | None,
    rig: Path | None,
    profile: str,
    speed: float,
    seed: int,
    svg: Path | None,
    *,
    is_quiet: bool = False,
) -> None:
    """Run device and service for `duration_s` of device time; show them live on a terminal, and sum up.

    Raises
    ------
    LinkError
        If the simulator or `serve` ended too early.
    """
    screen = Screen(duration_s) if is_screen(sys.stdout) and not is_quiet else None
    error = YawError()
    with tempfile.TemporaryDirectory(prefix="gyrodrift-demo-") as folder, ExitStack() as stack:
        log = stack.enter_context(_log(Path(folder))) if screen else None
        if screen:
            stack.enter_context(screen.live)
            screen.show(error)
        port = Path(folder) / DEVICE
        device = ["-m", "gyrodrift", "simulated-device", "--quiet", "--wait", "--link", str(port), "--profile", profile]
        device += ["--seed", str(seed), "--speed", str(speed)] + (["--rig", str(rig)] if rig else [])
        with _undisturbed():
            simulator = stack.enter_context(_process(device, None, log))
        _wait_for(port, simulator)
        config_path = config or shipped_config("gyrodrift.yaml")
        serve = ["-m", "gyrodrift", "serve", "--port", str(port), "--config", str(config_path)]
        with _undisturbed():
            service = stack.enter_context(_process([*serve, "--log-level", "warning"], subprocess.PIPE, log))
        _watch(_lines(service), error, duration_s, screen)
    if error.elapsed_s < duration_s:
        raise LinkError(f"the demo ended after {error.elapsed_s:.1f} of {duration_s:g} s: serve stopped; see above")
    if screen:
        screen.keep(error)
    for text in summary(error):
        print(text)  # noqa: T201 - the result of the demo
    if svg is not None:
        save_svg(svg, error, duration_s)


class Screen:
    """The screen of the terminal during the demo; each frame has the present size of the terminal."""

    def __init__(self, duration_s: float) -> None:
        self._console = Console(force_terminal=True)
        self._duration_s = duration_s
        self._next_s = 0.0
        self.live = Live(console=self._console, auto_refresh=False, screen=True)

    def show(self, error: YawError) -> None:
        """Draw a frame if one is due."""
        if time.monotonic() < self._next_s:
            return
        self._console.size = _size()
        self.live.update(draw(error, self._duration_s, DEVICE, Size(*self._console.size)), refresh=True)
        self._next_s = time.monotonic() + 1.0 / FRAMES_PER_S

    def keep(self, error: YawError) -> None:
        """Leave the last view on the terminal, with room for the summary."""
        size = _size()
        self._console.size = size
        self._console.print(draw(error, self._duration_s, DEVICE, Size(size.columns, size.rows - SUMMARY_ROWS)))


def save_svg(path: Path, error: YawError, duration_s: float) -> None:
    """Save the last view as a picture; it does not depend on the terminal."""
    console = Console(
        width=PICTURE.columns,
        file=io.StringIO(),
        record=True,
        force_terminal=True,
        color_system="truecolor",
        no_color=False,
        _environ={},  # TERM=dumb would make it 80 columns wide
    )
    console.print(draw(error, duration_s, DEVICE, PICTURE))
    write_whole(path, [console.export_svg(title="make demo", code_format=SVG_WITHOUT_WEB_FONTS)])


def _size() -> Size:
    """Size of the terminal; from the environment if the terminal does not tell."""
    try:
        size = os.get_terminal_size(sys.stdout.fileno())
    except OSError:
        size = shutil.get_terminal_size()
    return Size(*(size if size.columns and size.lines else shutil.get_terminal_size()))


@contextmanager
def _log(folder: Path) -> Iterator[BinaryIO]:
    """Log file of the processes while the view has the terminal; it is printed at the end."""
    path = folder / "log"
    try:
        with path.open("wb") as log:
            yield log
    finally:
        sys.stderr.write(path.read_text(errors="replace"))


def _watch(lines: Iterator[bytes | None], error: YawError, duration_s: float, screen: Screen | None) -> None:
    """Evaluate and show the lines of `serve` until the time is over."""
    for line in lines:
        if line is not None:
            error.add(json.loads(line))
        if screen:
            screen.show(error)
        if error.elapsed_s >= duration_s:
            return


def _lines(service: "subprocess.Popen[bytes]") -> Iterator[bytes | None]:
    """Lines of `serve`; None after a frame without a line, so that the view can follow the terminal."""
    assert service.stdout is not None  # noqa: S101 - it was opened with a pipe
    fd, pending = service.stdout.fileno(), b""
    while True:
        if not select.select([fd], [], [], 1.0 / FRAMES_PER_S)[0]:
            yield None
            continue
        chunk = os.read(fd, 1 << 16)
        if not chunk:
            return
        *lines, pending = (pending + chunk).split(b"\n")
        yield from lines


@contextmanager
def _process(arguments: list[str], stdout: int | None, log: BinaryIO | None) -> "Iterator[subprocess.Popen[bytes]]":
    """A Python process that ends with the block."""
    process = subprocess.Popen([sys.executable, *arguments], stdout=stdout, stderr=log)  # noqa: S603 - our own module
    try:
        yield process
    finally:
        process.terminate()
        try:
            process.wait(5.0)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        if process.stdout:
            process.stdout.close()


@contextmanager
def _undisturbed() -> Iterator[None]:
    """Delay signals to the end of the block, so that no started process is left behind."""
    endings: list[int] = []
    before = {ending: signal.signal(ending, lambda number, _: endings.append(number)) for ending in ENDINGS}
    try:
        yield
    finally:
        for ending, handler in before.items():
            signal.signal(ending, handler)
    if endings:
        raise KeyboardInterrupt


def _wait_for(port: Path, simulator: "subprocess.Popen[bytes]") -> None:
    until_s = time.monotonic() + STARTING_S
    while not port.exists():
        if time.monotonic() > until_s or simulator.poll() is not None:
            raise LinkError("the simulated device did not start; see above")
        time.sleep(0.01)
