"""Fixtures of the tests of commands."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from support import Command, Recording, never, speaking_on

from firmware_sim.pty import PtyDevice


@pytest.fixture
def out(tmp_path: Path) -> Path:
    """Folder for recordings, which does not exist yet."""
    return tmp_path / "sessions"


@pytest.fixture
def recording(port: Path, out: Path) -> Recording:
    """`record` with these options, which reads the device that comes with it."""

    @contextmanager
    def running(*options: str) -> Iterator[tuple[PtyDevice, Command]]:
        with speaking_on(port) as device, Command("record", "--port", port, "--out", out, *options) as record:
            device.wait_for_reader(never)
            yield device, record

    return running
