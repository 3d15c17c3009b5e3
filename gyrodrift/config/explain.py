"""What a value has to be and what it is instead, in words, from the annotations of a field."""

from typing import Any, Literal, get_args, get_origin

from annotated_types import Ge, Gt, Le, Lt, MaxLen, MinLen, Predicate
from pydantic import BaseModel, ConfigDict
from pydantic.fields import FieldInfo

from gyrodrift.nearest import did_you_mean
from gyrodrift.secret import LONGEST_SECRET, SecretText

UNITS = {"_dps": " deg/s", "_s": " s", "_hz": " Hz", "_deg": " deg"}


class Strict(BaseModel):
    """A block of keys: no other keys, no other types, finite numbers."""

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)


def unknown_key(name: str, known: list[str], where: str) -> str:
    """Of a key that is none, with the nearest that is one."""
    return f"is not {where}; {did_you_mean(name, known) or 'expected ' + (', '.join(known) or 'none')}"


def expectation(name: str, info: FieldInfo, unit: str | None = None) -> str:
    """What a field takes; its unit follows from its name where it is not given."""
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
        if any(isinstance(bound, Predicate) for bound in bounds):  # a host is the only one
            return f"a name or an address of up to {longest} characters, without user, password and path"
        shortest = any(isinstance(bound, MinLen) for bound in bounds)
        return f"text{' that is not empty' if shortest else ''}{f' of up to {longest} characters' if longest else ''}"
    return f"{'a whole number' if int in kinds else 'a number'} {_range(bounds)}{_unit(name) if unit is None else unit}"


def said(value: Any) -> str:
    """A value as somebody wrote it, and of what kind it is."""
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
    """The plain types of an annotation, out of unions and bounds."""
    if hasattr(annotation, "__metadata__"):
        return _kinds(annotation.__origin__)
    if get_origin(annotation) is Literal or not get_args(annotation):
        return [annotation]
    return [kind for option in get_args(annotation) for kind in _kinds(option)]


def _bounds(info: FieldInfo) -> list[Any]:
    """The bounds of a field; for an optional one they stand inside the union."""
    inner = [bound for option in get_args(info.annotation) for bound in getattr(option, "__metadata__", ())]
    return [*info.metadata, *inner]
