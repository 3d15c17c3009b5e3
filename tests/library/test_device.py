"""`open_link`: samples of a real port until it is closed, and errors that say what is wrong."""

from itertools import islice
from pathlib import Path
from typing import Any

import pytest
from support import PATIENCE_S, Command

from gyrodrift import open_link
from gyrodrift.values.errors import DeviceSilentError, PortMissingError, UsageError


def test_samples_come_until_it_is_closed(port: Path) -> None:
    """Iterated or read, in one order and with none lost between."""
    report: list[str] = []

    def tell(event: str, **fields: Any) -> None:
        report.append(event)

    with Command("--link", port, module="firmware_sim") as device:
        device.until(lambda _: port.exists(), "port")
        with open_link(str(port), on_event=tell) as link:
            samples = list(islice(link, 20))
            samples += link.read(PATIENCE_S)
            samples += link.read(PATIENCE_S)
            link.close()
            assert list(link) == []
            assert link.read(PATIENCE_S) == []
    numbers = [sample.seq for sample in samples]
    assert numbers == list(range(numbers[0], numbers[0] + len(numbers)))
    assert len(numbers) > 21
    assert report[:2] == ["link_open", "protocol_found"]


def test_what_is_wrong_is_said(port: Path, tmp_path: Path) -> None:
    with pytest.raises(PortMissingError, match="nowhere"):
        open_link(str(tmp_path / "nowhere"))
    with Command("--link", port, module="firmware_sim") as device:
        device.until(lambda _: port.exists(), "port")
        with pytest.raises(UsageError, match="morse"):
            open_link(str(port), protocol="morse")
        with open_link(str(port), protocol="witmotion", timeout_s=0.3) as link, pytest.raises(DeviceSilentError):
            next(link)
