"""The outputs there are, by name; a line below is all that one needs beside its own file."""

from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import Any

from gyrodrift.errors import UsageError
from gyrodrift.service.outputs.output import Output


@dataclass(frozen=True, slots=True)
class OutputKind:
    """One of them.

    name
        What a person calls it.
    help
        What it does, in a few words.
    module
        Where its `open_output(options)` is, which gives an `Output` for options by name; it is imported when the
        output is asked for, so that each costs only those who use it.
    """

    name: str
    help: str
    module: str


OUTPUTS: dict[str, OutputKind] = {}


def register(kind: OutputKind) -> None:
    """Let the service send corrected samples to one place more.

    Raises
    ------
    ValueError
        Where the name is taken.
    """
    if kind.name in OUTPUTS:
        raise ValueError(f"there is an output {kind.name!r} already")
    OUTPUTS[kind.name] = kind


def unregister(name: str) -> None:
    """Take an output away again."""
    del OUTPUTS[name]


def open_output(name: str, options: Mapping[str, Any]) -> Output:
    """The output of that name, ready for samples.

    Raises
    ------
    UsageError
        Where there is none of that name, or its options are none.
    """
    if name not in OUTPUTS:
        raise UsageError(f"there is no output {name!r}; known are {', '.join(OUTPUTS)}")
    output: Output = import_module(OUTPUTS[name].module).open_output(options)
    return output


register(OutputKind("stdout", "one JSON object a line on stdout", "gyrodrift.service.outputs.json_lines"))
