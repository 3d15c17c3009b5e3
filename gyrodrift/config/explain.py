"""The values that a field accepts, from its annotations, and words for them in error messages.

Options of outputs are checked here: pydantic, which checks whole configs, takes 9 MB of memory, and a service with
`--output` does without it.
"""

from collections.abc import Callable, Sequence
from math import isfinite
from typing import Any, Literal, NamedTuple, Protocol, get_args, get_origin

from annotated_types import Ge, Gt, Le, Lt, MaxLen, MinLen, Predicate

from gyrodrift.values.secret import LONGEST_SECRET, SecretText
from gyrodrift.values.words import did_you_mean

HOLDS: dict[type[Any], Callable[[Any, Any], bool]] = {
    Ge: lambda value, bound: value >= bound.ge,
    Gt: lambda value, bound: value > bound.gt,
    Le: lambda value, bound: value <= bound.le,
    Lt: lambda value, bound: value < bound.lt,
    MinLen: lambda value, bound: len(value) >= bound.min_length,
    MaxLen: lambda value, bound: len(value) <= bound.max_length,
    Predicate: lambda value, bound: bound.func(value),
}
"""Whether a value is within a bound. Other notes, such as descriptions, are no bounds."""

UNITS = {"_dps": " deg/s", "_s": " s", "_hz": " Hz", "_deg": " deg"}


class FieldInfo(Protocol):
    """A field: its type, and notes such as its bounds; `pydantic.fields.FieldInfo` is one."""

    @property
    def annotation(self) -> Any:
        """Type without the notes."""

    @property
    def metadata(self) -> Sequence[Any]:
        """Notes of `Annotated`."""


class Hint(NamedTuple):
    """A field of a dataclass, by its type hint."""

    annotation: Any
    metadata: tuple[Any, ...]


def field_of(hint: Any) -> Hint:
    """The field of a type hint with its extras."""
    notes = getattr(hint, "__metadata__", None)
    return Hint(hint, ()) if notes is None else Hint(hint.__origin__, notes)


def accepted(value: Any, info: FieldInfo) -> Any:
    """A value as the field keeps it.

    Raises
    ------
    ValueError
        If the field does not accept it.
    """
    kinds, bounds = _kinds(info.annotation), _bounds(info)
    if value is None and type(None) in kinds:
        return None
    for kind in kinds:
        if get_origin(kind) is Literal and isinstance(value, str) and value in get_args(kind):
            return value
        if kind is SecretText and isinstance(value, str | SecretText):
            return _secret(value)
        if kind in {bool, int, str} and type(value) is kind and all(_holds(value, bound) for bound in bounds):
            return value
        if kind is float and type(value) in {int, float} and all(_holds(value, bound) for bound in bounds):
            return _finite(value)
    raise ValueError


def _secret(value: str | SecretText) -> SecretText:
    if isinstance(value, SecretText):
        return value
    if len(value) > LONGEST_SECRET:
        raise ValueError
    return SecretText(value)


def _finite(value: float) -> float:
    try:
        number = float(value)
    except OverflowError:
        raise ValueError from None
    if not isfinite(number):
        raise ValueError
    return number


def _holds(value: Any, bound: Any) -> bool:
    return type(bound) not in HOLDS or HOLDS[type(bound)](value, bound)


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
