"""Starts the simulator and `serve`, reads what `serve` prints, and shows it."""

import json
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

from rich._export_format import CONSOLE_SVG_FORMAT
from rich.console import Console
from rich.live import Live

from gyrodrift.demo.view import draw, summary
from gyrodrift.demo.yaw_error import YawError
from gyrodrift.errors import LinkError
from gyrodrift.files import shipped_config, write_whole

FRAMES_PER_S = 10
STARTING_S = 10.0
WIDTH = 100
DEVICE = "gyro"

SVG_WITHOUT_WEB_FONTS = re.sub(r"@font-face \{\{.*?\}\}", "", CONSOLE_SVG_FORMAT, flags=re.DOTALL)
"""A picture that asks nobody for a font when it is looked at."""


def run_demo(
    duration_s: float,
    config: Path | None,
    rig: Path | None,
    profile: str,
    speed: float,
    seed: int,
    svg: Path | None,
) -> None:
    """Run device and service for `duration_s` of device time; show them live on a terminal, and sum up.

    Raises
    ------
    LinkError
        Where the simulator or `serve` ended before its time.
    """
    console = Console(width=WIDTH, record=svg is not None)
    error = YawError()
    with tempfile.TemporaryDirectory(prefix="gyrodrift-demo-") as folder, ExitStack() as stack:
        port = Path(folder) / DEVICE
        device = ["-m", "firmware_sim", "--quiet", "--wait", "--link", str(port), "--profile", profile]
        device += ["--seed", str(seed), "--speed", str(speed)] + (["--rig", str(rig)] if rig else [])
        _wait_for(port, stack.enter_context(_process(device, None)))
        config_path = config or shipped_config("gyrodrift.yaml")
        serve = ["-m", "gyrodrift", "serve", "--port", str(port), "--config", str(config_path)]
        service = stack.enter_context(_process([*serve, "--log-level", "warning"], subprocess.PIPE))
        _watch(_lines(service), error, duration_s, console)
    if error.elapsed_s < duration_s:
        raise LinkError(f"the demo ended after {error.elapsed_s:.1f} of {duration_s:g} s: serve stopped; see above")
    if svg is not None or _is_live(console):
        console.print(draw(error, duration_s, DEVICE))
    for text in summary(error):
        console.print(text, highlight=False)
    if svg is not None:
        write_whole(svg, [console.export_svg(title="make demo", code_format=SVG_WITHOUT_WEB_FONTS)])


def _watch(lines: Iterator[str], error: YawError, duration_s: float, console: Console) -> None:
    """Add up what `serve` prints until the time is over, and show it where somebody looks on."""
    with ExitStack() as stack:
        live = None
        if _is_live(console):
            live = stack.enter_context(Live(console=console, auto_refresh=False, transient=True))
        next_s = 0.0
        for line in lines:
            error.add(json.loads(line))
            if live and time.monotonic() >= next_s:
                live.update(draw(error, duration_s, DEVICE), refresh=True)
                next_s = time.monotonic() + 1.0 / FRAMES_PER_S
            if error.elapsed_s >= duration_s:
                return


def _is_live(console: Console) -> bool:
    return console.is_terminal and not console.is_dumb_terminal


def _lines(service: "subprocess.Popen[str]") -> Iterator[str]:
    assert service.stdout is not None  # noqa: S101 - it was opened with a pipe
    yield from service.stdout


@contextmanager
def _process(arguments: list[str], stdout: int | None) -> "Iterator[subprocess.Popen[str]]":
    """A Python process that is asked to end, and ended, when the block is left."""
    process = subprocess.Popen([sys.executable, *arguments], stdout=stdout, text=True)  # noqa: S603 - our own
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


def _wait_for(port: Path, simulator: "subprocess.Popen[str]") -> None:
    until_s = time.monotonic() + STARTING_S
    while not port.exists():
        if time.monotonic() > until_s or simulator.poll() is not None:
            raise LinkError("the simulated device did not start; see above")
        time.sleep(0.01)
