"""Outputs by name: what ships, and one that somebody adds."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import structlog
import toy_output
from support import never, speaking_on

from gyrodrift.errors import UsageError
from gyrodrift.link.events import LinkEvents
from gyrodrift.link.link import Link, LinkOptions
from gyrodrift.service.filtering import Filtering
from gyrodrift.service.loop import Service
from gyrodrift.service.outputs.json_lines import JsonLines
from gyrodrift.service.outputs.output import Output
from gyrodrift.service.outputs.registry import OUTPUTS, OutputKind, open_output, register, unregister
from gyrodrift.service.signals import StopSignal


@pytest.fixture
def toy() -> Iterator[str]:
    """An output more, for the time of a test."""
    register(OutputKind("last_yaw", "the yaw of the last sample in a file", toy_output.__name__))
    yield "last_yaw"
    unregister("last_yaw")


def stop_after(stop: StopSignal, count: int) -> Output:
    """An output that ends the service after so many samples."""

    class Counting(toy_output.LastYaw):
        def take(self, samples: list[Any]) -> None:
            super().take(samples)
            stop.is_set = self._samples >= count

    return Counting(Path("/dev/null"))


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
    log = structlog.get_logger()
    with structlog.testing.capture_logs() as logged:  # noqa: SIM117 - the log has to outlive the service
        with speaking_on(tmp_path / "gyro") as device, StopSignal() as stop:
            outputs = [open_output(toy, {"path": tmp_path / "yaw"}), stop_after(stop, 101)]
            link = Link(LinkOptions(str(tmp_path / "gyro")), LinkEvents(log))
            device.send_all(lines, never)
            Service(link, [Filtering(link, outputs[:1], log), Filtering(link, outputs[1:], log)], log,
                    LinkEvents(log), stop, outputs).run()  # fmt: skip
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
