"""Compile the plain Python source of a filter: one source, the same bits.

The functions of a filter access its records by attributes. Compiled structured arrays have attributes too, nested
records included, so the same source runs on both.
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
    """Compile a function and the functions of the same package that it calls."""
    made: Callable[..., Any] = njit(nogil=True, error_model="numpy")(_with_compiled_callees(function))
    return made


@cache
def compiled_callee(function: FunctionType) -> Callable[..., Any]:
    """Compile a function for compiled callers only: without a Python wrapper this takes a quarter less time."""
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
    """Structured type with the fields of a dataclass.

    A field is a float, an int, a bool, a dataclass, or a list of dataclasses as long as in a new record.
    """
    slots: list[tuple[Any, ...]] = []
    hints = get_type_hints(record)
    for slot in fields(record):
        kind = hints[slot.name]
        if kind in KINDS:
            slots.append((slot.name, KINDS[kind]))
        elif get_origin(kind) is list:
            (inner,) = get_args(kind)
            slots.append((slot.name, layout(inner), (len(getattr(record(), slot.name)),)))
        else:
            slots.append((slot.name, layout(kind)))
    return np.dtype(slots, align=True)


def array_of(value: Any) -> np.ndarray[tuple[int], np.dtype[Any]]:
    """Structured array with one record."""
    record: Any = type(value)
    made = np.zeros(1, layout(record))
    _fill(made[0], value)
    return made


def _fill(slot: Any, value: Any) -> None:
    for entry in fields(value):
        content = getattr(value, entry.name)
        if isinstance(content, list):
            for inner, part in zip(slot[entry.name], content, strict=True):
                _fill(inner, part)
        elif is_dataclass(content):
            _fill(slot[entry.name], content)
        else:
            slot[entry.name] = content
