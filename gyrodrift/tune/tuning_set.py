"""The sessions of a tuning: read, split, and ready to be asked for their costs, here or on a cluster."""

import hashlib
import json
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, replace
from types import TracebackType
from typing import Self

from gyrodrift.evaluation.cost import Cost
from gyrodrift.evaluation.dataset import (
    LoadedSession,
    SessionSummary,
    Source,
    Split,
    load_with_reference,
    split_sources,
)
from gyrodrift.evaluation.reference import Reference
from gyrodrift.progress import OnProgress
from gyrodrift.tune.tuning import Costs, Plan


class TuningSet:
    """Sessions and their costs; a context manager that gives back threads or the cluster.

    Raises
    ------
    DataError
        Where a session cannot be used, with its path.
    UsageError
        Where the cluster cannot be reached.
    """

    def __init__(
        self,
        sources: Sequence[Source],
        seed: int,
        threads: int | None,
        cluster: str | None,
        progress: OnProgress,
    ) -> None:
        self._sources = split_sources(sources, seed)
        self.splits = [source.split or Split.TRAIN for source in self._sources]
        self.sessions: list[SessionSummary] = []
        self.costs: Costs
        self._close: Callable[[], None]
        if cluster is None:
            local = Cost(self._references(progress), threads)
            self.costs, self._close = local, local.close
        else:
            from gyrodrift.evaluation.cluster_cost import ClusterCost  # noqa: PLC0415 - an extra that few have

            progress("sessions read by the cluster", 0, 1)
            seen = [(source.path.resolve(), source.is_still) for source in self._sources]
            shared = ClusterCost(cluster, seen, reading=self._sources[0].reading)
            self.costs, self._close, self.sessions = shared, shared.close, list(shared.descriptions)
        self.sessions = _with_folders(self.sessions, self._sources)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._close()

    def loaded(self, at: int) -> LoadedSession:
        """One of the sessions, read again."""
        return load_with_reference(self._sources[at])

    def _references(self, progress: OnProgress) -> Iterator[Reference]:
        """One after the other, so that nothing but what is evaluated stays in memory."""
        progress("sessions read", 0, len(self._sources))
        for done, source in enumerate(self._sources, 1):
            loaded = load_with_reference(source)
            self.sessions.append(loaded.description)
            progress("sessions read", done, len(self._sources))
            yield loaded.reference


def identity(plans: Sequence[Plan], tuning_set: TuningSet) -> str:
    """Digest of everything that the searches of a tuning depend on."""
    content: list[object] = []
    for plan in plans:
        content += [plan.filter.name, plan.method, plan.evaluations, *(asdict(axis) for axis in plan.axes)]
    content += [[one.digest, split.value] for one, split in zip(tuning_set.sessions, tuning_set.splits, strict=True)]
    return hashlib.sha256(json.dumps(content).encode()).hexdigest()


def _with_folders(sessions: Sequence[SessionSummary], sources: Sequence[Source]) -> list[SessionSummary]:
    """Sessions of one name carry the name of their folder too."""
    counts = Counter(one.name for one in sessions)
    return [
        replace(one, name=f"{source.path.parent.name}/{one.name}") if counts[one.name] > 1 else one
        for one, source in zip(sessions, sources, strict=True)
    ]
