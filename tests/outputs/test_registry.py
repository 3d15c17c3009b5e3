"""Outputs by name: what ships, and one that somebody adds."""

import sys
from collections.abc import Iterator
from types import ModuleType

import pytest
from outputs_support import connected, corrected, hub
from support import python_in

from gyrodrift.outputs.options import about
from gyrodrift.outputs.registry import OUTPUTS, OutputKind, register, unregister
from gyrodrift.values.errors import UsageError

RECORD, SOURCE, TEST = python_in("extending-output.md")
"""The record, the module and the test of the how-to."""
MODULE = "gyrodrift.outputs.plain_yaw"


@pytest.fixture
def plain_yaw(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """An output more, for the time of a test."""
    module = ModuleType(MODULE)
    monkeypatch.setitem(sys.modules, MODULE, module)
    exec(SOURCE, module.__dict__)
    register(eval(RECORD, {"OutputKind": OutputKind}))
    yield
    unregister("plain_yaw")


def test_the_output_of_the_how_to_passes_its_own_test(plain_yaw: None) -> None:
    names = {"hub": hub, "connected": connected, "corrected": corrected}
    assert "    assert " in TEST
    exec(TEST, names)
    names["test_it_sends_yaw"](None)  # type: ignore[operator]  # it stands in the text


@pytest.mark.parametrize("name", OUTPUTS)
def test_a_shipped_output_says_what_it_does(name: str) -> None:
    kind = OUTPUTS[name]
    assert kind.name == name
    assert kind.help
    options = kind.output.options_type
    assert all(about(options).values()), f"{name}: an option has no About"
    options()


def test_a_missing_package_is_told_with_what_installs_it() -> None:
    kind = OutputKind("toy", "", "nowhere:Toy", packages=("no_such_package",), extra="toy")
    with pytest.raises(UsageError, match=r"output toy needs the package no_such_package: .*\[toy\]'"):
        kind.check_packages()


@pytest.mark.usefixtures("plain_yaw")
def test_a_name_that_is_in_use_is_refused() -> None:
    """Outputs of others do not replace ours."""
    with pytest.raises(ValueError, match="there is an output 'plain_yaw' already"):
        register(OUTPUTS["plain_yaw"])
