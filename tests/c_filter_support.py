"""The filters of `gyrodrift.h`, compiled on this machine and run over arrays through ctypes."""

import ctypes
import shutil
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from built_once import built_once
from firmware_support import HERE, run
from numpy.typing import ArrayLike, NDArray

from gyrodrift.firmware.targets import gyrodrift_h
from gyrodrift.values.arrays import Floats

WARNINGS = ("-Wall", "-Wextra", "-Werror", "-Wconversion", "-Wdouble-promotion", "-Wshadow", "-pedantic")

EXACT = ("-O2", "-ffp-contract=off")
"""No fused operations, so that doubles are those of Python."""

NEVER_SAVED = 2**63

LIBRARY = "filter.so"


class FilterOutput(NamedTuple):
    """Whether the parameters are valid, which samples were taken, and the outputs after each, shape (samples, n)."""

    is_valid: bool
    taken: NDArray[np.bool_]
    rows: Floats
    is_done: NDArray[np.bool_] | None = None
    """After which samples no work was left, where it was done in portions."""


class CFilter:
    """A program of tests/firmware with filter_driver.h, as a library."""

    def __init__(self, library: Path) -> None:
        self._library = ctypes.CDLL(str(library))
        for name in ("state_bytes", "inputs", "outputs"):
            getattr(self._library, name).restype = ctypes.c_size_t
        pointer, size = ctypes.c_void_p, ctypes.c_size_t
        self._library.drive.argtypes = [pointer, size, pointer, ctypes.c_int, pointer, size, pointer, pointer, pointer]

    @property
    def state_bytes(self) -> int:
        """Size of the state on this machine."""
        return int(self._library.state_bytes())

    def run(
        self,
        t: ArrayLike,
        inputs: ArrayLike,
        params: Sequence[float] | None = None,
        *,
        is_us: bool = False,
        saved_after: int = NEVER_SAVED,
        portions: NDArray[np.uint8] | None = None,
    ) -> FilterOutput:
        """Run over samples: times in s, or in µs of the 32-bit clock; inputs of shape (samples, n).

        `portions` are the numbers of portions of work after each sample.
        """
        times = np.ascontiguousarray(t, dtype=np.float64)
        given = np.ascontiguousarray(inputs, dtype=np.float64)
        assert given.size == len(times) * self._library.inputs()
        rows = np.zeros((len(times), self._library.outputs()))
        taken = np.zeros(len(times), dtype=np.uint8)
        values = None if params is None else np.array(params, dtype=np.float64)
        is_valid = self._library.drive(
            None if values is None else values.ctypes.data,
            len(times),
            times.ctypes.data,
            int(is_us),
            given.ctypes.data,
            saved_after,
            None if portions is None else portions.ctypes.data,
            rows.ctypes.data,
            taken.ctypes.data,
        )
        return FilterOutput(bool(is_valid), taken % 2 == 1, rows, None if portions is None else taken < 2)


class CFilters:
    """Compiles each program once for float and for double."""

    def __init__(self) -> None:
        self._loaded: dict[tuple[str, ...], CFilter] = {}

    def get(self, source: str, real: str, *flags: str) -> CFilter:
        """Library of a C file of tests/firmware in a number type, with further flags of the compiler."""
        if shutil.which("cc") is None:
            pytest.skip("there is no C compiler: apt-get install gcc")
        key = (source, real, *flags)
        if key not in self._loaded:
            self._loaded[key] = CFilter(
                built_once("".join(key), lambda folder: compile_library(folder, *key)) / LIBRARY
            )
        return self._loaded[key]


INTERLEAVINGS: dict[str, Callable[[np.random.Generator, int], NDArray[np.int64]]] = {
    "all at once": lambda _, count: np.full(count, 255),
    "one after each sample": lambda _, count: np.ones(count, dtype=np.int64),
    "now and then": lambda rng, count: rng.integers(0, 12, count) * (rng.random(count) < 0.3),
    "for a while": lambda _, count: np.where(np.arange(count) % 5000 < 2500, 3, 0),
}
"""Numbers of portions of work after each sample."""


def assert_portions_change_nothing(
    library: CFilter, t_s: Floats, inputs: Floats, interleaving: str, correction: int
) -> None:
    """All outputs are the same bits whenever no work is left.

    The correction in the last sample, in this column, comes when the work is done.
    """
    portions = INTERLEAVINGS[interleaving](np.random.default_rng(3), len(t_s)).astype(np.uint8)
    usual, divided = library.run(t_s, inputs), library.run(t_s, inputs, portions=portions)
    assert divided.is_done is not None
    assert divided.is_done.mean() > 0.01
    assert (divided.taken == usual.taken).all()
    done, expected = (np.delete(output.rows[divided.is_done], correction, axis=1) for output in (divided, usual))
    assert np.array_equal(done, expected, equal_nan=True)


def compile_library(folder: Path, source: str, real: str, *flags: str) -> None:
    """`gyrodrift.h` and the library of a C file in a folder."""
    write_header(folder)
    run("cc", "-std=c11", *EXACT, "-shared", "-fPIC", *words(source, real), *flags, "-o", LIBRARY, "-lm",
        folder=folder)  # fmt: skip


def words(source: str, real: str) -> list[str]:
    """Words of a compiler for a file of tests/firmware; `gyrodrift.h` is in the present folder."""
    return [*WARNINGS, f"-DGD_REAL={real}", "-I.", f"-I{HERE}", str(HERE / source)]


def write_header(folder: Path) -> Path:
    """`gyrodrift.h` as users get it."""
    path = folder / "gyrodrift.h"
    path.write_text(gyrodrift_h(), encoding="utf-8")
    return path
