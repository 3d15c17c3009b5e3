"""Deprecated names work, warn, and are gone in the release that removes them."""

import subprocess
import sys

import pytest

from gyrodrift import __version__
from gyrodrift.cli import parser_of
from gyrodrift.io.deprecation import DEPRECATED, GyrodriftDeprecation


def test_a_deprecated_option_works_and_tests_see_its_warning() -> None:
    with pytest.warns(GyrodriftDeprecation, match=r"--threads: is --jobs now, and goes with 0\.3\.0"):
        arguments = parser_of("tune").read(["sessions", "--out", "x.yaml", "--threads", "2"])
    assert arguments.jobs == 2


def test_a_user_reads_one_line() -> None:
    words = ["-m", "gyrodrift", "tune", "/no/such/session", "--out", "/no/such.yaml", "--threads=2"]
    done = subprocess.run([sys.executable, *words], capture_output=True, text=True, check=False)
    assert done.stderr.splitlines()[0] == "gyrodrift: --threads: is --jobs now, and goes with 0.3.0"


def test_what_should_be_gone_is_gone() -> None:
    def numbers(text: str) -> tuple[int, ...]:
        return tuple(map(int, text.split(".")))

    assert [name for name, entry in DEPRECATED.items() if numbers(entry.removed_in) <= numbers(__version__)] == []
    assert all(numbers(entry.since)[:2] < numbers(entry.removed_in)[:2] for entry in DEPRECATED.values())
