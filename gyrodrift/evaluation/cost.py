"""Cost of parameters on recorded sessions: yaw errors of many candidates, on all processors."""

import copy
import mmap
import tempfile
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import IO, Self

import numpy as np

from gyrodrift.evaluation.kernels.kernel import SUMS, groups, kernel_of
from gyrodrift.evaluation.reference import Reference
from gyrodrift.evaluation.score import Score
from gyrodrift.filters.filter import Filter
from gyrodrift.filters.registry import PUBLISHED
from gyrodrift.io.system import memory_bytes_of_machine, processor_count
from gyrodrift.values.arrays import Floats

FLOAT_BYTES = 8
BLOCK = 512
"""Candidates at a time: the step tables of HDR take 64 MB, 128 KiB for each."""


@dataclass(frozen=True, slots=True)
class Scores:
    """Yaw errors by session and candidate, shape (sessions, c); inf if yaw overflows.

    mean_squares
        Mean squared error, deg².
    mean_absolutes
        Mean absolute error E, deg.
    worst
        Largest absolute error, deg.
    crps_deg
        Mean CRPS of yaw and its sigma, deg; NaN for a filter without sigma.
    """

    mean_squares: Floats
    mean_absolutes: Floats
    worst: Floats
    crps_deg: Floats

    @property
    def pi(self) -> Floats:
        """PI, the mean over the sessions of the mean squared error, deg², shape (c,)."""
        return _mean_of_sessions(self.mean_squares)

    @property
    def loss(self) -> Floats:
        """Cost of a search, deg², shape (c,): PI, or more if the stated sigma does not fit the errors.

        The mean over the sessions of the larger of the mean squared error and π·CRPS². Both are σ² for a normal error
        of standard deviation σ that is stated right, since its CRPS is σ/√π (Gneiting and Raftery 2007, equation 21).
        """
        with np.errstate(over="ignore"):
            return _mean_of_sessions(np.fmax(self.mean_squares, np.pi * self.crps_deg**2))

    @property
    def mean_crps_deg(self) -> Floats:
        """Mean CRPS over the sessions, deg, shape (c,); NaN for a filter without sigma."""
        return _mean_of_sessions(self.crps_deg)

    def score(self, session: int, candidate: int, minutes: float) -> Score:
        """Score of a candidate on a session of this duration."""
        tables = (self.mean_squares, self.mean_absolutes, self.worst, self.crps_deg)
        mean_square, e_deg, worst_deg, crps_deg = (float(table[session, candidate]) for table in tables)
        return Score(e_deg, e_deg / minutes, mean_square, worst_deg, None if np.isnan(crps_deg) else crps_deg)


def _mean_of_sessions(table: Floats) -> Floats:
    """Mean over the first axis; np.mean adds in another order if there is one candidate."""
    total = np.zeros(table.shape[1])
    with np.errstate(over="ignore"):
        for row in table:
            total += row
    return total / len(table)


class Cost:
    """Cost of candidates over sessions; a context manager that ends its threads.

    Parameters
    ----------
    references
        At least one; a generator may load them, since they are read in sequence.
    threads
        Number of threads; None for the number of processors. The results do not depend on it.
    memory_bytes
        Memory for references; further references go to a temporary file. None for half of the memory of the machine.
    chosen
        The filter.

    `evaluations` is the number of candidates so far.
    """

    def __init__(
        self,
        references: Iterable[Reference],
        threads: int | None = None,
        memory_bytes: int | None = None,
        chosen: Filter = PUBLISHED,
    ) -> None:
        self._kernel = kernel_of(chosen)
        self.references = tuple(
            _within_memory(references, memory_bytes_of_machine() // 2 if memory_bytes is None else memory_bytes)
        )
        self.evaluations = 0
        self._counts = np.array(
            [[np.count_nonzero(np.isfinite(reference.reference_deg))] for reference in self.references]
        )
        self.threads = threads or processor_count()
        self._pool = ThreadPoolExecutor(self.threads, "cost")

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def for_filter(self, chosen: Filter) -> Self:
        """Cost of another filter over the same references; closing this object ends the threads of both."""
        view = copy.copy(self)
        view._kernel, view.evaluations = kernel_of(chosen), 0  # noqa: SLF001 - of its own class
        return view

    def close(self) -> None:
        """End the threads."""
        self._pool.shutdown(cancel_futures=True)

    def cost(self, params: Floats, sessions: Sequence[int] | None = None) -> Scores:
        """Scores of candidates, shape (c, parameters of the filter), on the sessions with these indices, or on all."""
        session_indices = range(len(self.references)) if sessions is None else sessions
        sums = np.empty((SUMS, len(session_indices), len(params)))
        for first in range(0, len(params), BLOCK):
            block = slice(first, first + BLOCK)
            self._walk(params[block], session_indices, sums[:, :, block])
        self.evaluations += len(params)
        counts = self._counts[list(session_indices)]
        return Scores(sums[0] / counts, sums[1] / counts, sums[2], sums[3] / counts)

    def pi(self, params: Floats, sessions: Sequence[int] | None = None) -> Floats:
        """PI, deg², shape (c,); every session has the same weight."""
        return self.cost(params, sessions).pi

    def _walk(self, params: Floats, session_indices: Sequence[int], sums: Floats) -> None:
        """Compute the sums of `Kernel.sums`, shape (SUMS, sessions, c), the longest session first."""
        cuts = groups(len(params))
        tables = [self._kernel.prepare(params[cut]) for cut in cuts]

        def work(index: int, group: int) -> None:
            reference, cut = self.references[session_indices[index]], cuts[group]
            sums[:, index, cut] = self._kernel.sums(
                reference.dt_s,
                reference.rate_dps,
                reference.reference_deg,
                params[cut],
                tables[group],
                reference.auxiliary,
            )

        longest_first = sorted(
            range(len(session_indices)), key=lambda index: -len(self.references[session_indices[index]].dt_s)
        )
        for task in [self._pool.submit(work, index, group) for index in longest_first for group in range(len(cuts))]:
            task.result()


def _within_memory(references: Iterable[Reference], limit_bytes: int) -> list[Reference]:
    """References; beyond the limit their arrays are in a temporary file without a name, mapped into memory."""
    kept: list[Reference] = []
    offsets: list[int | None] = []
    total_bytes = 0
    with tempfile.TemporaryFile() as file:
        for reference in references:
            total_bytes += 3 * reference.dt_s.nbytes
            is_spilled = total_bytes > limit_bytes
            offsets.append(file.tell() // FLOAT_BYTES if is_spilled else None)
            kept.append(_written(reference, file) if is_spilled else reference)
        if total_bytes <= limit_bytes:
            return kept
        file.flush()
        spilled = np.frombuffer(mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ))
    return [
        reference if index is None else _read_back(reference, spilled[index:])
        for reference, index in zip(kept, offsets, strict=True)
    ]


def _written(reference: Reference, file: IO[bytes]) -> Reference:
    """Write the arrays of a reference to a file; the returned reference keeps only their length."""
    for values in (reference.dt_s, reference.rate_dps, reference.reference_deg):
        file.write(np.ascontiguousarray(values, dtype=np.float64).data)
    absent = np.broadcast_to(np.float64(0.0), len(reference.dt_s))
    return replace(reference, dt_s=absent, rate_dps=absent, reference_deg=absent)


def _read_back(reference: Reference, values: Floats) -> Reference:
    length = len(reference.dt_s)
    dt_s, rate_dps, reference_deg = (values[part * length :][:length] for part in range(3))
    return replace(reference, dt_s=dt_s, rate_dps=rate_dps, reference_deg=reference_deg)
