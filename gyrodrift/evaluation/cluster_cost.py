"""What parameters cost on recorded sessions, worked out on the machines of a Dask cluster, with the same bits.

The workers read the sessions, so the paths have to hold on them: a shared file system. Scheduler, workers and this
process need the same gyrodrift. Sessions are loaded in batches that stay where they were loaded; an evaluation sends
parameters to the batches and brings back three figures per session and candidate. Where a worker dies, Dask loads its
batches again elsewhere and repeats what is missing.

A worker needs 24 bytes of memory per sample of its share of all sessions, 70 more per sample of the session that each
of its threads is loading, and 250 MB for the program. Beyond 70 % of its limit Dask moves batches to the worker's
disk, which is slow and works. A task uses one thread: a worker keeps as many processors busy as it has threads.
"""

import copy
import socket
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain, pairwise
from math import ceil
from pathlib import Path
from types import TracebackType
from typing import Self

import numpy as np
from numpy.typing import NDArray

from gyrodrift import __version__
from gyrodrift.arrays import Floats
from gyrodrift.cluster import ClusterWorkers
from gyrodrift.errors import UsageError
from gyrodrift.evaluation.cost import BLOCK, Scores
from gyrodrift.evaluation.dataset import SessionSummary, Source, load_with_reference
from gyrodrift.evaluation.kernels.kernel import GROUP, groups, kernel_of
from gyrodrift.evaluation.reference import Reference
from gyrodrift.filters.filter import Filter
from gyrodrift.filters.registry import FILTERS, PUBLISHED
from gyrodrift.session.checks.stated import AS_WRITTEN, ReadingOptions

BATCHES_PER_THREAD = 2
"""So that a thread with quick batches may take over, while the scheduler, at up to a millisecond a task, keeps up."""

BATCH_BYTES = 1 << 30
BATCH_SESSIONS = 256
"""The largest batch, by the size of its files: what is lost with a worker, or moved to its disk, at a time."""

ARRAY_COUNT = 3


@dataclass(frozen=True, slots=True)
class Batch:
    """Some sessions in the memory of a worker: their references, what is known of them, and how many samples have one.

    counts
        Shape (sessions, 1).
    """

    references: tuple[Reference, ...]
    descriptions: tuple[SessionSummary, ...]
    counts: Floats

    def __sizeof__(self) -> int:
        """What Dask goes by when it places work and watches memory, bytes."""
        return ARRAY_COUNT * sum(reference.dt_s.nbytes for reference in self.references)


def load_batch(sources: Sequence[Source], version: str) -> Batch:
    """Load sessions, on a worker.

    Raises
    ------
    DataError
        Where a session cannot be read.
    UsageError
        Where the program here is of another version than the one that asks.
    """
    if version != __version__:
        raise UsageError(
            f"the worker on {socket.gethostname()} has gyrodrift {__version__}, this is {version}; "
            "install the same everywhere"
        )
    references, descriptions = [], []
    for source in sources:
        loaded = load_with_reference(source)
        references.append(loaded.reference)
        descriptions.append(loaded.description)
    counts = np.array([[float(np.count_nonzero(np.isfinite(reference.reference_deg)))] for reference in references])
    return Batch(tuple(references), tuple(descriptions), counts)


def descriptions_of(batch: Batch) -> tuple[SessionSummary, ...]:
    """What is known of the sessions of a batch."""
    return batch.descriptions


def score_batch(batch: Batch, places: NDArray[np.int64], params: Floats, name: str) -> Floats:
    """Mean squares, mean absolutes and worst of candidates of a filter, shape (3, places, c), by one thread."""
    kernel, found = kernel_of(FILTERS[name]), np.empty((3, len(places), len(params)))
    for cut in groups(len(params)):
        group = params[cut]
        prepared = kernel.prepare(group)
        for at, place in enumerate(places.tolist()):
            reference = batch.references[place]
            found[:, at, cut] = kernel.sums(
                reference.dt_s, reference.rate_dps, reference.reference_deg, group, prepared, reference.beside
            )
    found[:2] /= batch.counts[places]
    return found


class ClusterCost:
    """The cost of candidates over sessions that workers hold; a context manager that leaves the cluster.

    Parameters
    ----------
    address
        Of the scheduler, as in `tcp://host:8786`.
    sessions
        Paths as the workers see them, at least one, and whether each is a still.
    chosen
        The filter.
    reading
        What a person states of columns and units.

    Raises
    ------
    UsageError
        Where the package is missing, there is no cluster at the address, or its gyrodrift is another one.
    DataError
        Of the first session that cannot be used.
    GyrodriftError
        Where the cluster is lost, here or in any call.

    `threads` counts those of the workers at the beginning, `evaluations` the candidates so far; `descriptions` says
    what is known of each session. Results are those of `Cost`, bit for bit, whichever worker holds what.
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
            found = self._workers.results(self._workers.submit(descriptions_of, self._batches))
        except BaseException:
            self.close()
            raise
        self.descriptions: tuple[SessionSummary, ...] = tuple(chain.from_iterable(found))

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def for_filter(self, chosen: Filter) -> Self:
        """Cost of another filter over the same sessions; the cluster is left when this object is closed."""
        view = copy.copy(self)
        view._name, view.evaluations = chosen.name, 0  # noqa: SLF001 - of its own class
        return view

    def close(self) -> None:
        """Leave the cluster; the workers drop the sessions."""
        self._workers.close()

    def cost(self, params: Floats, sessions: Sequence[int] | None = None) -> Scores:
        """Scores of candidates, shape (c, parameters of the filter), over some of the sessions or all."""
        on = np.arange(len(self.descriptions)) if sessions is None else np.asarray(sessions, np.int64)
        number = np.searchsorted(self._edges, on, side="right") - 1
        asked = [(batch, np.flatnonzero(number == batch)) for batch in np.unique(number).tolist()]
        cuts = _cuts(len(params), ceil(self.threads / max(1, len(asked))))
        rows = [(batch, at, cut) for batch, at in asked for cut in cuts]
        tasks = self._workers.submit(
            score_batch,
            [self._batches[batch] for batch, _, _ in rows],
            [on[at] - self._edges[batch] for batch, at, _ in rows],
            [params[cut] for _, _, cut in rows],
            [self._name] * len(rows),
        )
        found = np.empty((3, len(on), len(params)))
        for (_, at, cut), scores in zip(rows, self._workers.results(tasks), strict=True):
            found[:, at, cut] = scores
        self.evaluations += len(params)
        return Scores(*found)

    def pi(self, params: Floats, sessions: Sequence[int] | None = None) -> Floats:
        """PI, deg², shape (c,): every session counts the same, however long."""
        return self.cost(params, sessions).pi


def _edges(paths: Sequence[Path], threads: int) -> list[int]:
    """Where batches of about the same size begin, and at last the number of sessions."""
    ends = np.cumsum([_file_bytes(path) for path in paths], dtype=np.float64)
    batches = max(BATCHES_PER_THREAD * threads, ceil(ends[-1] / BATCH_BYTES), ceil(len(paths) / BATCH_SESSIONS))
    inside = np.searchsorted(ends, ends[-1] / batches * np.arange(1, batches))
    return [*dict.fromkeys([0, *inside.tolist()]), len(paths)]


def _file_bytes(path: Path) -> int:
    """1 where the file is not seen from here."""
    try:
        return max(1, path.stat().st_size)
    except OSError:
        return 1


def _cuts(candidates: int, parts: int) -> list[slice]:
    """Candidates in that many parts or more, of whole groups and of at most a block."""
    size = min(BLOCK, ceil(candidates / parts / GROUP) * GROUP)
    return [slice(first, first + size) for first in range(0, candidates, size)] if candidates else []
