"""Outputs by name: what ships, and one that somebody adds."""

import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest
import structlog
from support import never, python_in, speaking_on

from gyrodrift.errors import UsageError
from gyrodrift.link.events import LinkEvents
from gyrodrift.link.link import Link, LinkOptions
from gyrodrift.sample import Corrected
from gyrodrift.service.filtering import Filtering
from gyrodrift.service.loop import Service
from gyrodrift.service.outputs.json_lines import JsonLines
from gyrodrift.service.outputs.registry import OUTPUTS, OutputKind, open_output, register, unregister
from gyrodrift.service.signals import StopSignal

LINE, SOURCE = python_in("extending-output.md")
"""The registration and the module of the how-to."""
MODULE = "gyrodrift.service.outputs.last_yaw"


@pytest.fixture
def toy(monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """An output more, for the time of a test."""
    module = ModuleType(MODULE)
    exec(SOURCE, module.__dict__)
    monkeypatch.setitem(sys.modules, MODULE, module)
    exec(LINE, {"register": register, "OutputKind": OutputKind})
    yield "last_yaw"
    unregister("last_yaw")


class StopAfter(JsonLines):
    """Lines for nobody, and the end of the service after so many samples."""

    def __init__(self, fd: int, stop: StopSignal, count: int) -> None:
        super().__init__(fd)
        self._stop, self._count = stop, count

    def take(self, samples: list[Corrected]) -> None:
        super().take(samples)
        self._stop.is_set = self.lines >= self._count


@pytest.mark.parametrize("name", OUTPUTS)
def test_a_shipped_output_says_what_it_does(name: str) -> None:
    """And is found by the name it has."""
    assert OUTPUTS[name].name == name
    assert OUTPUTS[name].help


def test_stdout_takes_json_lines() -> None:
    """As many as it is told to."""
    assert isinstance(open_output("stdout", {"rate_hz": 10.0}), JsonLines)


def test_an_output_that_is_added_hears_the_samples_of_a_link(toy: str, tmp_path: Path) -> None:
    """One second at 10 deg/s is 10 degrees, and its fields are in the log."""
    lines = b"".join(b"%d,10.0\n" % (i * 10_000) for i in range(101))
    log, port = structlog.get_logger(), tmp_path / "gyro"
    with (
        structlog.testing.capture_logs() as logged,
        speaking_on(port) as device,
        StopSignal() as stop,
        Path("/dev/null").open("wb") as null,
    ):
        outputs = [open_output(toy, {"path": tmp_path / "yaw"}), StopAfter(null.fileno(), stop, 101)]
        link = Link(LinkOptions(str(port)), LinkEvents(log))
        device.send_all(lines, never)
        Service(link, [Filtering(link, outputs, log)], log, LinkEvents(log), stop, outputs).run()
    assert (tmp_path / "yaw").read_text() == "10.000\n"
    assert logged[-1]["noted"] == 101


def test_an_output_that_is_taken_away_is_unknown(toy: str) -> None:
    """And its name is free again, while a name that is in use is refused."""
    with pytest.raises(ValueError, match="there is an output 'last_yaw' already"):
        register(OUTPUTS[toy])
    kind = OUTPUTS[toy]
    unregister(toy)
    with pytest.raises(UsageError, match="there is no output 'last_yaw'; known are stdout"):
        open_output(toy, {})
    register(kind)
