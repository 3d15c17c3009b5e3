"""Filters written in plain Python, compiled as they stand: one source, and so the same bits.

A filter's functions take its records by their attributes. Structured arrays of numpy have attributes too once they
are compiled, records within records included, so the same source runs on both.
"""

from collections.abc import Callable
from dataclasses import fields, is_dataclass
from functools import cache
from types import FunctionType
from typing import Any, get_args, get_origin, get_type_hints

import numpy as np
from numba import njit

KINDS: dict[Any, str] = {float: "f8", int: "i8", bool: "?"}


def compiled(function: FunctionType) -> Callable[..., Any]:
    """The function and all that it calls of the same package, compiled."""
    made: Callable[..., Any] = njit(nogil=True, error_model="numpy")(_with_compiled_callees(function))
    return made


@cache
def compiled_callee(function: FunctionType) -> Callable[..., Any]:
    """The function, compiled for compiled callers only: Python cannot call it, which compiles a quarter faster."""
    options: dict[str, Any] = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
    made: Callable[..., Any] = njit(nogil=True, error_model="numpy", **options)(_with_compiled_callees(function))
    return made


def _with_compiled_callees(function: FunctionType) -> FunctionType:
    package = function.__module__.split(".")[0]
    names = dict(function.__globals__)
    for name in function.__code__.co_names:
        called = names.get(name)
        if isinstance(called, FunctionType) and called.__module__.split(".")[0] == package:
            names[name] = compiled_callee(called)
    return FunctionType(function.__code__, names, function.__name__, function.__defaults__, function.__closure__)


@cache
def layout(record: type) -> np.dtype[Any]:
    """The structured type with the fields of a dataclass.

    A field is a float, an int, a bool, another such dataclass, or a list of one: as many as a new record has.
    """
    places: list[tuple[Any, ...]] = []
    hints = get_type_hints(record)
    for place in fields(record):
        kind = hints[place.name]
        if kind in KINDS:
            places.append((place.name, KINDS[kind]))
        elif get_origin(kind) is list:
            (inner,) = get_args(kind)
            places.append((place.name, layout(inner), (len(getattr(record(), place.name)),)))
        else:
            places.append((place.name, layout(kind)))
    return np.dtype(places, align=True)


def array_of(value: Any) -> np.ndarray[tuple[int], np.dtype[Any]]:
    """A record as a structured array of one."""
    record: Any = type(value)
    made = np.zeros(1, layout(record))
    _fill(made[0], value)
    return made


def _fill(place: Any, value: Any) -> None:
    for each in fields(value):
        content = getattr(value, each.name)
        if isinstance(content, list):
            for inner, one in zip(place[each.name], content, strict=True):
                _fill(inner, one)
        elif is_dataclass(content):
            _fill(place[each.name], content)
        else:
            place[each.name] = content
