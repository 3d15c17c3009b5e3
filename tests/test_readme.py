"""README.md: its Python runs as it is printed there, and its length stays that of a page which is read in a minute."""

import builtins
from collections.abc import Callable
from pathlib import Path

import pytest
from support import Command, python_in

README = Path(__file__).parents[1] / "README.md"
MOST_LINES = 150
SAMPLES = 200


class EnoughError(Exception):
    """The reader has as many samples as the test wants."""


def printing_until(yaw_deg: list[float]) -> Callable[[float], None]:
    """A `print` that keeps yaw and ends the loop of the example."""

    def keep(value: float) -> None:
        yaw_deg.append(value)
        if len(yaw_deg) == SAMPLES:
            raise EnoughError

    return keep


def test_the_python_of_the_readme_prints_yaw_of_a_device(port: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The example ends only when its reader has enough, so `print` ends it here."""
    (code,) = python_in("../README.md")
    assert len([line for line in code.splitlines() if line]) <= 6
    yaw_deg: list[float] = []
    monkeypatch.setattr(builtins, "print", printing_until(yaw_deg))
    with Command("--link", port, "--profile", "rest", module="firmware_sim") as device:
        device.until(lambda _: port.exists(), "port")
        with pytest.raises(EnoughError):
            exec(compile(code.replace("/dev/ttyUSB0", str(port)), "README.md", "exec"), {})
    assert len(yaw_deg) == SAMPLES
    assert abs(yaw_deg[-1]) < 2.0


def test_the_readme_is_read_in_a_minute() -> None:
    assert len(README.read_text().splitlines()) <= MOST_LINES
