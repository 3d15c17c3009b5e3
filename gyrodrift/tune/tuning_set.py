"""Sessions of a tuning: loaded, split, with their costs on this machine or on a cluster."""

import hashlib
import json
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, replace
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
from gyrodrift.io.progress import OnProgress
from gyrodrift.tune.tuning import Costs, Plan


class TuningSet:
    """Sessions and their costs; a context manager that ends the threads or leaves the cluster.

    Raises
    ------
    DataError
        If a session cannot be used; the message has its path.
    UsageError
        If the cluster cannot be reached.
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
            from gyrodrift.evaluation.cluster_cost import ClusterCost

            progress("sessions read by the cluster", 0, 1)
            paths = [(source.path.resolve(), source.is_still) for source in self._sources]
            shared = ClusterCost(cluster, paths, reading=self._sources[0].reading)
            self.costs, self._close, self.sessions = shared, shared.close, list(shared.descriptions)
        self.sessions = _with_folders(self.sessions, self._sources)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._close()

    def loaded(self, index: int) -> LoadedSession:
        """Load a session again."""
        return load_with_reference(self._sources[index])

    def _references(self, progress: OnProgress) -> Iterator[Reference]:
        """Load the sessions one by one: only their references stay in memory."""
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
    content += [
        [session.digest, split.value] for session, split in zip(tuning_set.sessions, tuning_set.splits, strict=True)
    ]
    return hashlib.sha256(json.dumps(content).encode()).hexdigest()


def _with_folders(sessions: Sequence[SessionSummary], sources: Sequence[Source]) -> list[SessionSummary]:
    """Add the folder to the names of sessions that are not unique."""
    counts = Counter(session.name for session in sessions)
    return [
        replace(session, name=f"{source.path.parent.name}/{session.name}") if counts[session.name] > 1 else session
        for session, source in zip(sessions, sources, strict=True)
    ]
