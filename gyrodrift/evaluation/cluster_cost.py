"""Cost of parameters on recorded sessions, computed on a Dask cluster, bit for bit as on one machine.

The workers read the sessions, so all machines need the same paths: a shared file system. Scheduler, workers and this
process need the same version of gyrodrift. A batch of sessions stays on the worker that loaded it. An evaluation sends
parameters to the batches and returns three numbers for each session and candidate. If a worker dies, Dask loads its
batches on another worker and repeats its tasks.

A worker needs 250 MB for the program and 24 bytes per sample of its sessions. Loading a session takes another 70 bytes
per sample. If a worker uses more than 70 % of its memory limit, Dask moves batches to its disk, which is slow. A task
uses one thread: a worker keeps as many processors busy as it has threads.
"""

import copy
import socket
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain, pairwise
from math import ceil
from pathlib import Path
from typing import Self

import numpy as np
from numpy.typing import NDArray

from gyrodrift import __version__
from gyrodrift.evaluation.cost import BLOCK, Scores
from gyrodrift.evaluation.dataset import SessionSummary, Source, load_with_reference
from gyrodrift.evaluation.kernels.kernel import GROUP, SUMS, groups, kernel_of
from gyrodrift.evaluation.reference import Reference
from gyrodrift.filters.filter import Filter
from gyrodrift.filters.registry import FILTERS, PUBLISHED
from gyrodrift.io.parallel import ClusterWorkers
from gyrodrift.session.checks.stated import AS_WRITTEN, ReadingOptions
from gyrodrift.values.arrays import Floats
from gyrodrift.values.errors import UsageError

BATCHES_PER_THREAD = 2
"""More batches than threads balance the load; a batch costs the scheduler up to a millisecond: chosen."""

BATCH_BYTES = 1 << 30
BATCH_SESSIONS = 256
"""Largest batch, by file size and by sessions: chosen. A worker that dies loses whole batches."""

ARRAY_COUNT = 3
"""Arrays of a reference: steps, rates and reference angles."""


@dataclass(frozen=True, slots=True)
class Batch:
    """Sessions in the memory of a worker: references, descriptions, and numbers of samples with a reference.

    counts
        Shape (sessions, 1).
    """

    references: tuple[Reference, ...]
    descriptions: tuple[SessionSummary, ...]
    counts: Floats

    def __sizeof__(self) -> int:
        """Size for the placement and the memory limits of Dask, bytes."""
        return ARRAY_COUNT * sum(reference.dt_s.nbytes for reference in self.references)


def load_batch(sources: Sequence[Source], version: str) -> Batch:
    """Load sessions, on a worker.

    Raises
    ------
    DataError
        If a session cannot be read.
    UsageError
        If the worker has another version of gyrodrift.
    """
    if version != __version__:
        raise UsageError(
            f"the worker on {socket.gethostname()} has gyrodrift {__version__}, this machine {version}; "
            "install the same version everywhere"
        )
    references, descriptions = [], []
    for source in sources:
        loaded = load_with_reference(source)
        references.append(loaded.reference)
        descriptions.append(loaded.description)
    counts = np.array([[float(np.count_nonzero(np.isfinite(reference.reference_deg)))] for reference in references])
    return Batch(tuple(references), tuple(descriptions), counts)


def descriptions_of(batch: Batch) -> tuple[SessionSummary, ...]:
    """Descriptions of the sessions of a batch."""
    return batch.descriptions


def score_batch(batch: Batch, indices: NDArray[np.int64], params: Floats, name: str) -> Floats:
    """Arrays of `Scores` of candidates, shape (SUMS, sessions, c), computed by one thread."""
    kernel, scores = kernel_of(FILTERS[name]), np.empty((SUMS, len(indices), len(params)))
    for cut in groups(len(params)):
        group = params[cut]
        prepared = kernel.prepare(group)
        for row, index in enumerate(indices.tolist()):
            reference = batch.references[index]
            scores[:, row, cut] = kernel.sums(
                reference.dt_s, reference.rate_dps, reference.reference_deg, group, prepared, reference.auxiliary
            )
    scores[[0, 1, 3]] /= batch.counts[indices]
    return scores


class ClusterCost:
    """The cost of candidates over sessions that workers hold; a context manager that leaves the cluster.

    Parameters
    ----------
    address
        Address of the scheduler, such as `tcp://host:8786`.
    sessions
        Paths on the workers, at least one, with a flag: the device did not move.
    chosen
        The filter.
    reading
        Options for columns and units.

    Raises
    ------
    UsageError
        If the package is missing, the address has no cluster, or the cluster has another version of gyrodrift.
    DataError
        For the first session that cannot be used.
    GyrodriftError
        If the cluster is lost, now or in a later call.

    `threads` is the number of threads of the workers at the beginning, `evaluations` the number of candidates so far.
    `descriptions` has one entry for each session. Results equal those of `Cost` bit for bit.
    """

    def __init__(
        self,
        address: str,
        sessions: Sequence[tuple[Path, bool]],
        chosen: Filter = PUBLISHED,
        reading: ReadingOptions = AS_WRITTEN,
    ) -> None:
        self._name = chosen.name
        self.evaluations = 0
        self._workers = ClusterWorkers(address, "tuning")
        try:
            self.threads = self._workers.threads
            self._edges = _edges([path for path, _ in sessions], self.threads)
            sources = [Source(path, is_still, reading=reading) for path, is_still in sessions]
            cut = [sources[first:last] for first, last in pairwise(self._edges)]
            self._batches = self._workers.submit(load_batch, cut, [__version__] * len(cut))
            scores = self._workers.results(self._workers.submit(descriptions_of, self._batches))
        except BaseException:
            self.close()
            raise
        self.descriptions: tuple[SessionSummary, ...] = tuple(chain.from_iterable(scores))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def for_filter(self, chosen: Filter) -> Self:
        """Cost of another filter over the same sessions; closing this object leaves the cluster."""
        view = copy.copy(self)
        view._name, view.evaluations = chosen.name, 0  # noqa: SLF001 - of its own class
        return view

    def close(self) -> None:
        """Leave the cluster; the workers drop the sessions."""
        self._workers.close()

    def cost(self, params: Floats, sessions: Sequence[int] | None = None) -> Scores:
        """Scores of candidates, shape (c, parameters of the filter), on the sessions with these indices, or on all."""
        session_indices = np.arange(len(self.descriptions)) if sessions is None else np.asarray(sessions, np.int64)
        batch_of = np.searchsorted(self._edges, session_indices, side="right") - 1
        chosen_batches = [(batch, np.flatnonzero(batch_of == batch)) for batch in np.unique(batch_of).tolist()]
        cuts = _cuts(len(params), ceil(self.threads / max(1, len(chosen_batches))))
        rows = [(batch, positions, cut) for batch, positions in chosen_batches for cut in cuts]
        tasks = self._workers.submit(
            score_batch,
            [self._batches[batch] for batch, _, _ in rows],
            [session_indices[positions] - self._edges[batch] for batch, positions, _ in rows],
            [params[cut] for _, _, cut in rows],
            [self._name] * len(rows),
        )
        scores = np.empty((SUMS, len(session_indices), len(params)))
        for (_, positions, cut), part in zip(rows, self._workers.results(tasks), strict=True):
            scores[:, positions, cut] = part
        self.evaluations += len(params)
        return Scores(*scores)

    def pi(self, params: Floats, sessions: Sequence[int] | None = None) -> Floats:
        """PI, deg², shape (c,); every session has the same weight."""
        return self.cost(params, sessions).pi


def _edges(paths: Sequence[Path], threads: int) -> list[int]:
    """First session of each batch, then the number of sessions; batches have about the same size."""
    ends = np.cumsum([_file_bytes(path) for path in paths], dtype=np.float64)
    batches = max(BATCHES_PER_THREAD * threads, ceil(ends[-1] / BATCH_BYTES), ceil(len(paths) / BATCH_SESSIONS))
    inside = np.searchsorted(ends, ends[-1] / batches * np.arange(1, batches))
    return [*dict.fromkeys([0, *inside.tolist()]), len(paths)]


def _file_bytes(path: Path) -> int:
    """Size of a file, bytes; 1 if this machine does not have the file."""
    try:
        return max(1, path.stat().st_size)
    except OSError:
        return 1


def _cuts(candidates: int, parts: int) -> list[slice]:
    """Slices of the candidates: at least `parts`, in whole groups, and at most a block long."""
    size = min(BLOCK, ceil(candidates / parts / GROUP) * GROUP)
    return [slice(first, first + size) for first in range(0, candidates, size)] if candidates else []
