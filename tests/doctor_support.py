"""What the tests of `doctor` share: a simulated device that waits for its reader, and the findings about it."""

import json
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from support import Command

from gyrodrift.cli import main

Findings = dict[str, dict[str, Any]]

FAST = ("--speed", "40")
"""Device seconds in a second; 2 s of listening are 80 s, of which a busy machine may miss half."""

SECONDS = "2"


@contextmanager
def device(port: Path, *words: str | Path) -> Iterator[Command]:
    """A simulated gyro that boots when its port is opened."""
    with Command("--link", port, "--quiet", "--wait", *words, module="firmware_sim") as simulator:
        simulator.until(lambda _: port.is_symlink(), "port")
        yield simulator


def doctor(capsys: pytest.CaptureFixture[str], *words: str | Path) -> tuple[int, Findings]:
    """Exit status and findings by id of the command, run in this process."""
    status = main(["doctor", "--json", *map(str, words)])
    said = capsys.readouterr()
    assert said.out, said.err
    (line,) = said.out.splitlines()
    about = json.loads(line)
    return status, {each["id"]: each for each in about["findings"]}


def assert_findings(found: Findings, expected: Sequence[tuple[str, str, str]]) -> None:
    """Each of (id, severity, words that it says or advises)."""
    for name, severity, words in expected:
        assert name in found, f"{name} is not among {', '.join(found)}"
        told = f"{found[name]['says']} → {found[name]['do']}"
        assert (found[name]["severity"], words in told) == (severity, True), f"{name} {found[name]['severity']}: {told}"
