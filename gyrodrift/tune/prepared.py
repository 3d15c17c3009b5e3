"""What a tuning works on: the sessions read, split, and ready to be asked for their costs, here or on a cluster."""

import hashlib
import json
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, replace
from types import TracebackType
from typing import Self

from gyrodrift.evaluation.cost import Cost
from gyrodrift.evaluation.dataset import About, Source, Split, load_course, split_sources
from gyrodrift.evaluation.reference import Course
from gyrodrift.evaluation.tunables import HDR_TUNABLE, Tunable
from gyrodrift.progress import Progress
from gyrodrift.tune.tuning import Costs, Plan


class Prepared:
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
        progress: Progress,
        tunable: Tunable = HDR_TUNABLE,
    ) -> None:
        self._sources = split_sources(sources, seed)
        self.splits = [source.split or Split.TRAIN for source in self._sources]
        self.abouts: list[About] = []
        self.costs: Costs
        self._close: Callable[[], None]
        if cluster is None:
            local = Cost(self._courses(progress), threads, tunable=tunable)
            self.costs, self._close = local, local.close
        else:
            from gyrodrift.evaluation.cluster_cost import ClusterCost  # noqa: PLC0415 - an extra that few have

            progress.evaluated("sessions read by the cluster", 0, 1)
            seen = [(source.path.resolve(), source.is_still) for source in self._sources]
            shared = ClusterCost(cluster, seen, tunable)
            self.costs, self._close, self.abouts = shared, shared.close, list(shared.abouts)
        self.abouts = _told_apart(self.abouts, self._sources)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._close()

    def course(self, at: int) -> Course:
        """One of the sessions, read again."""
        return load_course(self._sources[at])[0]

    def _courses(self, progress: Progress) -> Iterator[Course]:
        for done, source in enumerate(self._sources, 1):
            course, about = load_course(source)
            self.abouts.append(about)
            progress.evaluated("sessions read", done, len(self._sources))
            yield course


def identity(plan: Plan, prepared: Prepared) -> str:
    """What the searches of a tuning depend on, as a digest."""
    about: list[object] = [plan.tunable.filter.name, plan.method, plan.evaluations]
    about += [asdict(axis) for axis in plan.axes]
    about += [[one.digest, split.value] for one, split in zip(prepared.abouts, prepared.splits, strict=True)]
    return hashlib.sha256(json.dumps(about).encode()).hexdigest()


def _told_apart(abouts: Sequence[About], sources: Sequence[Source]) -> list[About]:
    """Sessions of one name carry the name of their folder too."""
    counts = Counter(about.name for about in abouts)
    return [
        replace(about, name=f"{source.path.parent.name}/{about.name}") if counts[about.name] > 1 else about
        for about, source in zip(abouts, sources, strict=True)
    ]
