"""Things that a command line picks from a catalogue: `name`, or `name:parameter=value,...`."""

from collections.abc import Callable, Mapping
from difflib import get_close_matches
from typing import Any

from pydantic import ValidationError

from firmware_sim.yaml_file import FileError, Model, problems_of


def parse_named(
    noun: str, text: str, catalogue: Mapping[str, type[Model]], bare: Callable[[type[Model]], Mapping[str, Any]]
) -> Model:
    """What `--noun text` asks for; `bare` gives the parameters of one that is named and no more.

    Raises
    ------
    FileError
        Where there is no such thing or parameter, or a value is none or out of range.
    """
    name, _, listed = text.partition(":")
    if name not in catalogue:
        nearest = get_close_matches(name, catalogue, n=1)
        hint = f"did you mean {nearest[0]}?" if nearest else f"known are {', '.join(catalogue)}"
        raise FileError(f"--{noun} {text}: there is no {noun} {name!r}; {hint}")
    kind = catalogue[name]
    # A kind that a file can state has its own name as a field, which is no parameter.
    defaults = {key: field.default for key, field in kind.model_fields.items() if field.default != name}
    values = {} if listed else dict(bare(kind))
    for pair in filter(None, listed.split(",")):
        parameter, _, value = pair.partition("=")
        is_word = isinstance(defaults.get(parameter), str)
        try:
            values[parameter] = value if is_word else _number(value)
        except ValueError:
            raise FileError(f"--{noun} {text}: {parameter} is {value!r}; expected a number") from None
    try:
        return kind.model_validate(values)
    except ValidationError as error:
        problems = "; ".join(problems_of(error))
        raise FileError(f"--{noun} {text}: {problems} (parameters: {', '.join(defaults)})") from error


def _number(text: str) -> float:
    return int(text) if text.lstrip("+-").isdecimal() else float(text)
