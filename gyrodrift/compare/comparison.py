"""A comparison from its paths to its result: methods tuned where that is asked for, and run over every session."""

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from gyrodrift.compare.methods.method import Method, Params
from gyrodrift.compare.methods.registry import by_key
from gyrodrift.compare.tuning import tuned
from gyrodrift.evaluation.curves import YawCurves, yaw_curves
from gyrodrift.evaluation.dataset import (
    LoadedSession,
    SessionSummary,
    Source,
    folder_names,
    load_with_reference,
    rates_differ,
)
from gyrodrift.evaluation.score import Score, mean_score, score_of
from gyrodrift.parallel import workers
from gyrodrift.progress import OnProgress, untold

CURVE_POINTS = 300
PLOTTED = 24
"""Of more sessions than this, curves are kept of the first of each folder only."""


@dataclass(frozen=True, slots=True)
class ComparisonRequest:
    """What is to be compared.

    paths, stills
        The sessions, and those of them, or more, that did not move.
    train
        Sessions to tune on; without any nothing is tuned.
    iterations, seed
        Of the search for each method.
    """

    paths: Sequence[Path]
    methods: Sequence[Method]
    train: Sequence[Path] = ()
    stills: frozenset[Path] = frozenset()
    iterations: int = 3000
    seed: int = 0
    jobs: int = 1
    progress: OnProgress = untold


@dataclass(frozen=True, slots=True)
class Entry:
    """A row of the comparison: a method with the parameters it ran with."""

    method: Method
    params: Params
    is_tuned: bool = False

    @property
    def title(self) -> str:
        """For people."""
        marks = [word for word, is_so in (("tuned", self.is_tuned), ("offline", self.method.is_offline)) if is_so]
        return ", ".join([self.method.title, *marks])


@dataclass(frozen=True, slots=True)
class ComparedSession:
    """A session with a score for every entry, in their order; `curves` have a yaw for each, where it is plotted."""

    session: SessionSummary
    folder: str
    scores: tuple[Score, ...]
    curves: YawCurves | None = None


@dataclass(frozen=True, slots=True)
class Comparison:
    """All of it.

    missing
        Methods that could not run, since their packages are not installed.
    train
        Names of the sessions that the tuned entries were tuned on, after that of their folder.
    notes, seconds
        What should be known before believing it, a sentence each, and how long it took.
    """

    entries: tuple[Entry, ...]
    missing: tuple[Method, ...]
    sessions: tuple[ComparedSession, ...]
    train: tuple[str, ...]
    iterations: int
    seed: int
    notes: tuple[str, ...]
    seconds: float

    @property
    def means(self) -> tuple[Score, ...]:
        """Over all sessions, by entry."""
        return _means(self.sessions)

    @property
    def folders(self) -> dict[str, tuple[Score, ...]]:
        """Over the sessions of each folder, by entry."""
        names = dict.fromkeys(one.folder for one in self.sessions)
        return {name: _means([one for one in self.sessions if one.folder == name]) for name in names}


def _means(sessions: Sequence[ComparedSession]) -> tuple[Score, ...]:
    return tuple(mean_score(scores) for scores in zip(*(one.scores for one in sessions), strict=True))


def compare(asked: ComparisonRequest) -> Comparison:
    """Run every method that is installed over every session.

    Raises
    ------
    DataError
        Where a session cannot be read or has no reference.
    """
    begun_s = time.monotonic()
    present = [method for method in asked.methods if method.is_installed]
    train = _loaded(asked)
    found = tuned(present, train, asked.iterations, asked.seed, asked.jobs, asked.progress) if train else {}
    entries = [Entry(method, method.defaults) for method in present]
    entries += [Entry(method, found[method.key], is_tuned=True) for method in present if method.key in found]
    sessions, trained_in = _run(asked, entries), folder_names(asked.train)
    return Comparison(
        entries=tuple(entries),
        missing=tuple(method for method in asked.methods if not method.is_installed),
        sessions=tuple(sessions),
        train=tuple(f"{folder}/{path.stem}" for folder, path in zip(trained_in, asked.train, strict=True)),
        iterations=asked.iterations,
        seed=asked.seed,
        notes=tuple(_notes(entries, sessions, train)),
        seconds=time.monotonic() - begun_s,
    )


def _source(path: Path, asked: ComparisonRequest) -> Source:
    return Source(path, path in asked.stills)


def _loaded(asked: ComparisonRequest) -> list[LoadedSession]:
    found = []
    for done, path in enumerate(asked.train):
        asked.progress("sessions to tune on", done, len(asked.train))
        found.append(load_with_reference(_source(path, asked)))
    return found


def _run(asked: ComparisonRequest, entries: Sequence[Entry]) -> list[ComparedSession]:
    folders = folder_names(asked.paths)
    firsts = {folders.index(name) for name in folders}
    is_plotted = [len(folders) <= PLOTTED or at in firsts for at in range(len(folders))]
    works = [
        _Work(_source(path, asked), folder, [(entry.method.key, entry.params) for entry in entries], plotted)
        for path, folder, plotted in zip(asked.paths, folders, is_plotted, strict=True)
    ]
    found = []
    asked.progress("sessions", 0, len(works))
    with workers(min(asked.jobs, len(works))) as pool:
        for done, one in enumerate(pool.map(_compared, works), 1):
            asked.progress("sessions", done, len(works))
            found.append(one)
    return found


@dataclass(frozen=True, slots=True)
class _Work:
    """A session's part, small enough to be sent to another process."""

    source: Source
    folder: str
    runs: list[tuple[str, Params]]
    is_plotted: bool


def _compared(work: _Work) -> ComparedSession:
    loaded, known = load_with_reference(work.source), by_key()
    reference = loaded.reference
    yaws_deg = [known[key].run(loaded.t_s, reference.rate_dps, params) for key, params in work.runs]
    scores = tuple(score_of(reference, yaw_deg) for yaw_deg in yaws_deg)
    curves = yaw_curves(loaded, yaws_deg, CURVE_POINTS) if work.is_plotted else None
    return ComparedSession(loaded.description, work.folder, scores, curves)


def _notes(
    entries: Sequence[Entry], compared: Sequence[ComparedSession], train: Sequence[LoadedSession]
) -> Iterator[str]:
    sessions, trained_on = [one.session for one in compared], [one.description for one in train]
    yield from (warning for session in sessions for warning in session.warnings)
    digests = {session.digest for session in trained_on}
    both = [session.name for session in sessions if session.digest in digests]
    if both:
        yield f"the tuned rows flatter: they were tuned on {', '.join(both)} too, which they are scored on"
    counting = " and of ".join(one.method.title for one in entries if one.is_tuned and one.method.counts_samples)
    if counting and rates_differ([session.sample_rate_hz for session in [*sessions, *trained_on]]):
        yield f"sample rates differ: tuned steps of {counting} count samples of one rate"
