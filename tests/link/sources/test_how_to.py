"""The source of docs/extending-source.md, added as the page says."""

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from sources_support import Host
from support import python_in

from gyrodrift.link.link import Link
from gyrodrift.link.options import LinkOptions
from gyrodrift.link.sources import registry
from gyrodrift.values.errors import PortMissingError
from gyrodrift.values.sample import Sample

(SOURCE,) = python_in("extending-source.md")


@pytest.fixture
def fifo() -> Iterator[str]:
    """The source, for the time of a test."""
    module: dict[str, Any] = {}
    exec(SOURCE, module)
    registry.register(module["FIFO"])
    yield "fifo"
    registry.unregister("fifo")


def test_a_source_that_is_added_is_read(fifo: str, tmp_path: Path) -> None:
    """Text through a named pipe, detected as on a cable."""
    pipe, samples = tmp_path / "gyro", list[Sample]()
    os.mkfifo(pipe)
    with Host(f"{fifo}:{pipe}") as host, pipe.open("wb", buffering=0) as writer:
        for number in range(200):
            writer.write(b"%d,0.5\n" % (number * 10_000))
            samples += host.read(0.01)
    assert len(samples) == 200
    assert samples[-1].rate_dps == 0.5


def test_an_error_of_an_added_source_says_what_to_do(fifo: str, tmp_path: Path) -> None:
    with pytest.raises(PortMissingError, match=r"fifo:.*none: No such file or directory; make it with mkfifo .*none"):
        Link(LinkOptions(f"{fifo}:{tmp_path}/none"), lambda *_, **__: None)


def test_a_scheme_has_one_source(fifo: str) -> None:
    with pytest.raises(ValueError, match="there is a source 'fifo' already"):
        registry.register(registry.source_named(fifo))
