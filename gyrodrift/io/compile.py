"""Compile numerical functions, and keep the compiled code for later runs."""

from collections.abc import Callable
from contextlib import suppress
from hashlib import blake2b
from importlib import import_module
from pathlib import Path
from typing import Any, TypeVar

from numba import njit

Function = TypeVar("Function", bound=Callable[..., Any])


def stamp_of(package: str) -> str:
    """Digest of all sources of a package."""
    digest = blake2b()
    for path in sorted(Path(import_module(package).__path__[0]).rglob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()


def compiled_once(*, nogil: bool = True, **options: Any) -> Callable[[Function], Function]:
    """`numba.njit` with a cache on the disk; without a writable cache folder, every run compiles again.

    Division by zero gives inf or NaN, as in numpy. `options` are options of `njit`.
    """

    def compiled(function: Function) -> Function:
        made: Any = njit(nogil=nogil, error_model="numpy", **options)(function)
        with suppress(RuntimeError):  # numba finds no folder for its cache
            made.enable_caching()
        result: Function = made
        return result

    return compiled
