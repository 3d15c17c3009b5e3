"""Compiling numerical functions: once for all runs where there is a place to keep what was compiled."""

from collections.abc import Callable
from contextlib import suppress
from hashlib import blake2b
from importlib import import_module
from pathlib import Path
from typing import Any, TypeVar

from numba import njit

Function = TypeVar("Function", bound=Callable[..., Any])


def stamp_of(package: str) -> str:
    """Of all sources of a package: another one wherever one of them has changed."""
    found = blake2b()
    for path in sorted(Path(import_module(package).__path__[0]).rglob("*.py")):
        found.update(path.read_bytes())
    return found.hexdigest()


def compiled_once(*, nogil: bool = True, **options: Any) -> Callable[[Function], Function]:
    """Numba's `njit` with its cache; in each run anew where neither the package nor a home can be written to.

    Division by zero gives what numpy gives. `options` are those of `njit`.
    """

    def compiled(function: Function) -> Function:
        made: Any = njit(nogil=nogil, error_model="numpy", **options)(function)
        with suppress(RuntimeError):  # numba finds no folder for its cache
            made.enable_caching()
        found: Function = made
        return found

    return compiled
