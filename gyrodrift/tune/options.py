"""A tuning as the command and the library ask for it: its options, its plan for each filter, and its run."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from gyrodrift.evaluation.dataset import Source, Split
from gyrodrift.evaluation.space import with_ranges
from gyrodrift.filters.filter import Filter
from gyrodrift.filters.registry import FILTERS, SHIPPED
from gyrodrift.io.progress import OnProgress
from gyrodrift.session.checks.given import AS_GIVEN, InputOptions, check_count, check_name, check_seeds
from gyrodrift.session.files import session_paths
from gyrodrift.tune.choice import tune_filters
from gyrodrift.tune.result import Tuning
from gyrodrift.tune.search.journal import Journal
from gyrodrift.tune.search.methods import METHODS
from gyrodrift.tune.tuning import Plan
from gyrodrift.tune.tuning_set import TuningSet, identity
from gyrodrift.values.errors import UsageError

METHOD = "race"
"""Search method for a filter that is named."""

METHODS_OF_BOTH = {"hdr": "carla", "restlevel": METHOD}
"""Search method of each filter if none is named: HDR as published, with CARLA."""


def plans_of(
    filter_name: str | None, evaluations: int, seeds: tuple[int, ...], method: str | None, ranges: Sequence[str]
) -> tuple[Plan, ...]:
    """One plan for the named filter, or one for each shipped filter.

    Parameters
    ----------
    ranges
        `NAME=LOW:HIGH`; a range applies to the filter that has the parameter.

    Raises
    ------
    UsageError
        If no planned filter has a parameter, or a range is wrong.
    """
    chosen = SHIPPED if filter_name is None else (FILTERS[filter_name],)
    _check_names(chosen, ranges)
    return tuple(
        Plan(
            evaluations,
            seeds,
            method or (METHOD if filter_name else METHODS_OF_BOTH.get(kind.name, METHOD)),
            with_ranges([text for text in ranges if _name(text) in kind.names], kind),
            kind,
        )
        for kind in chosen
    )


def _name(text: str) -> str:
    return text.partition("=")[0].strip()


def _check_names(chosen: Sequence[Filter], ranges: Sequence[str]) -> None:
    names = [name for kind in chosen for name in kind.names]
    for text in ranges:
        if _name(text) not in names:
            raise UsageError(f"--range {text}: unknown parameter {_name(text)}; there are {', '.join(names)}")


@dataclass(frozen=True, slots=True)
class TuneOptions:
    """Options of a tuning.

    paths, tests, stills
        Sessions or folders of sessions: to tune on, to hold out, and those in which the device did not move.
    filter
        Name of the filter to tune; None for HDR and restlevel.
    iterations, seeds, method
        Evaluations of each search, the seed of each search, and the search method; None for that of the filter.
    ranges
        `NAME=LOW:HIGH`, the search range of a parameter.
    jobs, cluster
        Threads, None for one per processor; address of a Dask cluster to use instead.

    Raises
    ------
    UsageError
        If there is no such filter or method, or a number is out of range.
    """

    paths: Sequence[Path]
    tests: Sequence[Path] = ()
    stills: Sequence[Path] = ()
    filter: str | None = None
    iterations: int = 3000
    seeds: tuple[int, ...] = (0,)
    method: str | None = None
    ranges: Sequence[str] = ()
    jobs: int | None = None
    cluster: str | None = None
    inputs: InputOptions = AS_GIVEN

    def __post_init__(self) -> None:
        if self.filter is not None:
            check_name("filter", self.filter, FILTERS)
        if self.method is not None:
            check_name("method", self.method, METHODS)
        check_count("iterations", self.iterations)
        check_seeds(self.seeds)


def run_tuning(
    options: TuneOptions, journal_path: Path, progress: OnProgress, *, is_resumed: bool = False
) -> tuple[Tuning, bool]:
    """Result of a tuning, and whether it was interrupted; the journal then keeps its evaluations.

    Raises
    ------
    UsageError
        If a range is wrong, an output is an input, or the cluster cannot be reached.
    DataError
        If a session cannot be used.
    """
    sources = _sources(options)
    options.inputs.check([source.path for source in sources])
    plans = plans_of(options.filter, options.iterations, options.seeds, options.method, options.ranges)
    with TuningSet(sources, options.seeds[0], options.jobs, options.cluster, progress) as sessions:
        journal = Journal(journal_path, identity(plans, sessions), is_resumed=is_resumed)
        tuning, was_interrupted = tune_filters(plans, sessions, journal, progress)
    if was_interrupted:
        journal.save()
    else:
        journal.discard()
    return tuning, was_interrupted


def _sources(options: TuneOptions) -> list[Source]:
    tests, stills = set(session_paths(options.tests)), set(session_paths(options.stills))
    paths = dict.fromkeys([*session_paths([*options.paths, *options.stills]), *sorted(tests)])
    reading = options.inputs.reading
    return [Source(path, path in stills, Split.TEST if path in tests else None, reading) for path in paths]
