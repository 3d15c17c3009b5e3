"""Effects and faults from a command line: `name`, or `name:parameter=value,...`."""

from collections.abc import Callable, Mapping
from difflib import get_close_matches
from typing import Any

from pydantic import ValidationError

from firmware_sim.yaml_file import FileError, Model, problems_of


def parse_named(
    noun: str, text: str, catalogue: Mapping[str, type[Model]], bare: Callable[[type[Model]], Mapping[str, Any]]
) -> Model:
    """Effect or fault of `--noun text`; `bare` returns the parameters for a name without any.

    Raises
    ------
    FileError
        The name or a parameter is unknown, or a value is invalid.
    """
    name, _, listed = text.partition(":")
    if name not in catalogue:
        nearest = get_close_matches(name, catalogue, n=1)
        hint = f"did you mean {nearest[0]}?" if nearest else f"there are {', '.join(catalogue)}"
        raise FileError(f"--{noun} {text}: there is no {noun} {name!r}; {hint}")
    kind = catalogue[name]
    # Kinds in rig files have their name as a field, which is not a parameter.
    is_kind_of_many = "name" in kind.model_fields and kind.model_fields["name"].is_required()
    own = {"name": name} if is_kind_of_many else {}
    fields = {key: field for key, field in kind.model_fields.items() if key not in own}
    defaults = {key: field.default for key, field in fields.items() if field.default != name}
    values: dict[str, Any] = own | ({} if listed else dict(bare(kind)))
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
