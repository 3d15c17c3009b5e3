"""`gyrodrift top` on a running service, in a terminal of the test."""

import io
import os
import re
from contextlib import ExitStack
from pathlib import Path

import pytest
from outputs_support import address_of, connected, csv_at_100_hz, serving
from rich.console import Console
from support import Command, Terminal, never, ours

from gyrodrift.outputs.status import ClientStatus, FilterStatus, LinkStatus, OutputStatus, ServiceStatus
from gyrodrift.top.view import YawPoint, draw, figures, sparkline


def top_on(control: Path) -> Terminal:
    """In a window that shows everything."""
    return Terminal(*ours("top", control), columns=100, rows=40)


def shows(terminal: Terminal, pattern: str) -> None:
    terminal.until(lambda it: bool(re.search(pattern, it.text)), pattern)


def test_a_service_is_watched_zeroed_and_waited_for(port: Path, tmp_path: Path) -> None:
    path = tmp_path / "control"
    with ExitStack() as stack:
        serve, device = stack.enter_context(
            serving(port, "--filter", "hdr", "--control", path, "--output", "tcp:port=0")
        )
        stack.enter_context(connected(address_of(serve, "tcp")))
        device.send_all(csv_at_100_hz(201), never)
        serve.take_lines(201)
        top = stack.enter_context(top_on(path))
        shows(top, r"Yaw +\+20\.00 deg")
        for label in ("Bias", "At rest", r"Temperature +25.0 °C", "Sample rate", "Jitter", r"Gaps +0"):
            shows(top, label)
        shows(top, r"127\.0\.0\.1:")
        top.keys("z")
        shows(top, r"Yaw +\+0\.00 deg")
        shows(top, "yaw is 0")
        top.keys("p")
        shows(top, "paused")
        top.keys("p")
        assert serve.stop() == 0
        shows(top, "waiting")
        top.keys("q")
        assert top.end() == 0


def test_it_ends_with_its_terminal(port: Path, tmp_path: Path) -> None:
    path = tmp_path / "control"
    with ExitStack() as stack:
        serve, _ = stack.enter_context(serving(port, "--control", path))
        serve.until(lambda _: path.exists(), "control socket")
        top = stack.enter_context(top_on(path))
        shows(top, "Yaw")
        assert top.hang_up() == 0
        assert serve.stop() == 0


def test_without_a_terminal_the_state_is_printed_once(port: Path, tmp_path: Path) -> None:
    path = tmp_path / "control"
    with serving(port, "--filter", "hdr", "--control", path) as (serve, device):
        device.send_all(csv_at_100_hz(101), never)
        serve.take_lines(101)
        with Command("top", path) as top:
            assert top.end() == 0
        assert "+10.00 deg" in top.out
        assert serve.stop() == 0
    with Command("top", path) as top:
        assert top.end() == 2
    assert "there is no such socket; is serve running with --control?" in top.log


def test_clients_and_what_is_wrong_are_shown() -> None:
    clients = tuple(ClientStatus(f"127.0.0.1:{50_000 + n}", 100, n) for n in range(10))
    status = ServiceStatus(
        link=LinkStatus(port="/dev/gyro", is_open=True, samples=10, damaged=3, gaps=1, missing=7),
        filter=FilterStatus(
            yaw_deg=1.0,
            yaw_sigma_deg=0.5,
            scale_sigma_deg=0.25,
            bias_dps=-0.25,
            bias_sigma_dps=0.01,
            rest_probability=0.97,
        ),
        outputs=(OutputStatus("tcp", "127.0.0.1:7117", "", clients, 10, 1000, 45),),
    )
    console = Console(width=100, file=open(os.devnull, "w"), record=True)  # noqa: PTH123, SIM115 - closed below
    console.print(draw(status, [YawPoint(0.0, 0.0, 0.5), YawPoint(0.25, 1.0, 0.5)]))
    console.file.close()
    shown = console.export_text()
    for statement in (
        "+1.00 ± 0.50 deg",
        "0.25 deg",
        "-0.2500 ± 0.0100 deg/s",
        "97%",
        "1 (7 samples)",
        "127.0.0.1:50007",
        "and 2 more",
    ):
        assert statement in shown
    assert "3 frames are damaged (23.1%); check cable, ground and baud." in shown


def test_a_zero_has_no_minus_sign() -> None:
    """A yaw just below zero rounds to zero."""
    status = ServiceStatus(filter=FilterStatus(yaw_deg=-0.004, bias_dps=-0.00004))
    values = {figure.label: figure.says for figure in figures(status)}
    assert (values["Yaw"], values["Bias"]) == ("+0.00 deg", "+0.0000 deg/s")


@pytest.mark.parametrize(("columns", "rows"), [(80, 24), (200, 50)])
def test_the_view_fills_the_terminal_with_a_chart(columns: int, rows: int) -> None:
    """Axes with round numbers; lines differ by their style."""
    points = [YawPoint(n / 4.0, n / 10.0, 1.0) for n in range(480)]
    status = ServiceStatus(link=LinkStatus(port="/dev/gyro", is_open=True, samples=10))
    console = Console(width=columns, height=rows, file=io.StringIO(), force_terminal=True, color_system=None)
    with console.capture() as shown:
        console.print(draw(status, points, "note", (columns, rows)))
    lines = shown.get().splitlines()
    assert [len(line) for line in lines] == [columns] * rows
    text = "\n".join(lines)
    for words in ("── yaw", "╌╌ ± 2 sigma", "┤", "┬", "40 ", "-100", "q quit"):
        assert words in text


def tilted_status(roll_deg: float, pitch_deg: float) -> ServiceStatus:
    now = FilterStatus(roll_deg=roll_deg, pitch_deg=pitch_deg, tilt_deg=22.2687, tilt_sigma_deg=0.4)
    return ServiceStatus(link=LinkStatus(port="/dev/gyro", is_open=True, samples=10), filter=now)


@pytest.mark.parametrize(("columns", "rows"), [(80, 24), (200, 50)])
def test_a_tilted_device_has_a_horizon_beside_the_chart(columns: int, rows: int) -> None:
    points = [YawPoint(n / 4.0, n / 10.0, 1.0) for n in range(480)]
    console = Console(width=columns, height=rows, file=io.StringIO(), force_terminal=True, color_system=None)
    with console.capture() as shown:
        console.print(draw(tilted_status(10.0, -20.0), points, "", (columns, rows)))
    text = shown.get()
    assert [len(line) for line in text.splitlines()] == [columns] * rows
    for words in ("+10.0 deg, right side down", "-20.0 deg, nose up", "22.3 ± 0.40 deg", "───┼──", "⣿⣿⣿"):
        assert words in text


def test_without_a_terminal_the_angles_are_words() -> None:
    """Angles that are shown as 0 have no direction."""
    values = {figure.label: figure.says for figure in figures(tilted_status(0.04, -0.04))}
    assert (values["Roll"], values["Pitch"]) == ("+0.0 deg", "+0.0 deg")
    assert "Roll" not in {figure.label for figure in figures(ServiceStatus())}


@pytest.mark.parametrize(
    ("values", "expected"),
    [([], ""), ([1.0], "▁"), ([0.0, 7.0], "▁█"), ([0.0, 0.01], "▁▁"), (list(range(8)), "▁▂▃▄▅▆▇█")],
)
def test_a_sparkline_goes_from_the_least_to_the_most(values: list[float], expected: str) -> None:
    assert sparkline(values) == expected
