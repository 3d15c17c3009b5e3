"""Words for error messages: the values that a field accepts, from its annotations, and the value it has."""

from typing import Any, Literal, get_args, get_origin

from annotated_types import Ge, Gt, Le, Lt, MaxLen, MinLen, Predicate
from pydantic import BaseModel, ConfigDict
from pydantic.fields import FieldInfo

from gyrodrift.values.secret import LONGEST_SECRET, SecretText
from gyrodrift.values.words import did_you_mean

UNITS = {"_dps": " deg/s", "_s": " s", "_hz": " Hz", "_deg": " deg"}


class Strict(BaseModel):
    """A block of keys: no other keys, no other types, finite numbers."""

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)


def unknown_key(name: str, names: list[str], where: str) -> str:
    """Message for an unknown key, with the nearest name that exists."""
    return f"is not {where}; {did_you_mean(name, names) or 'expected ' + (', '.join(names) or 'none')}"


def expectation(name: str, info: FieldInfo, unit: str | None = None) -> str:
    """Values that a field accepts. Without `unit` the unit follows from the name."""
    kinds = [kind for kind in _kinds(info.annotation) if kind is not type(None)]
    for kind in kinds:
        if get_origin(kind) is Literal:
            return " or ".join(map(str, get_args(kind)))
    if bool in kinds:
        return "true or false"
    bounds = _bounds(info)
    if SecretText in kinds:
        return f"text of up to {LONGEST_SECRET} characters"
    if str in kinds:
        longest = next((bound.max_length for bound in bounds if isinstance(bound, MaxLen)), None)
        if any(isinstance(bound, Predicate) for bound in bounds):  # only hosts have a predicate
            return f"a name or an address of up to {longest} characters, without user, password and path"
        shortest = any(isinstance(bound, MinLen) for bound in bounds)
        return f"text{' that is not empty' if shortest else ''}{f' of up to {longest} characters' if longest else ''}"
    return f"{'a whole number' if int in kinds else 'a number'} {_range(bounds)}{_unit(name) if unit is None else unit}"


def describe_value(value: Any) -> str:
    """A value as written in a file, with its type."""
    match value:
        case None:
            return "empty"
        case bool():
            return f"{str(value).lower()} (a truth value)"
        case str():
            return f"{value!r} (text)"
        case dict():
            return "a block of keys"
        case list():
            return "a list"
        case _:
            return f"{value:g}"


def _range(bounds: list[Any]) -> str:
    low = high = ""
    for bound in bounds:
        match bound:
            case Ge(ge):
                low = f"from {ge:g}"
            case Gt(gt):
                low = f"above {gt:g}"
            case Le(le):
                high = f"{'to' if low.startswith('from') else 'up to'} {le:g}"
            case Lt(lt):
                high = f"below {lt:g}" if not low else f"to below {lt:g}"
    return f"{low} {high}"


def _unit(name: str) -> str:
    return next((unit for suffix, unit in UNITS.items() if name.endswith(suffix)), "")


def _kinds(annotation: Any) -> list[Any]:
    """Plain types of an annotation, without unions and bounds."""
    if hasattr(annotation, "__metadata__"):
        return _kinds(annotation.__origin__)
    if get_origin(annotation) is Literal or not get_args(annotation):
        return [annotation]
    return [kind for option in get_args(annotation) for kind in _kinds(option)]


def _bounds(info: FieldInfo) -> list[Any]:
    """Bounds of a field; those of an optional field stand inside the union."""
    inner = [bound for option in get_args(info.annotation) for bound in getattr(option, "__metadata__", ())]
    return [*info.metadata, *inner]
