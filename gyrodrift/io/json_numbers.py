"""Numbers for JSON, which has neither NaN nor infinity: they become null."""

from math import isfinite
from typing import Any, TypeVar

Number = TypeVar("Number", bound=float)


def finite(value: Number | None) -> Number | None:
    """A finite number, or None."""
    return value if value is not None and isfinite(value) else None


def finite_values(value: Any) -> Any:
    """A value of dicts and lists with only finite numbers, else None."""
    if isinstance(value, dict):
        return {name: finite_values(inner) for name, inner in value.items()}
    if isinstance(value, list):
        return [finite_values(inner) for inner in value]
    return finite(value) if isinstance(value, float) else value
