"""A comparison from its paths to its result: methods tuned where that is asked for, and run over every session."""

import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import Any

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.compare.methods.method import Method, Params
from gyrodrift.compare.methods.registry import by_key
from gyrodrift.compare.tuning import tuned
from gyrodrift.evaluation.curves import YawCurves, yaw_curves
from gyrodrift.evaluation.dataset import (
    LoadedSession,
    SessionSummary,
    Source,
    digest_of,
    folder_names,
    load_with_reference,
    rates_differ,
)
from gyrodrift.evaluation.score import Score, mean_score, score_of
from gyrodrift.evaluation.uncertainty import Uncertainty, mean_uncertainty, uncertainty_of
from gyrodrift.parallel import workers
from gyrodrift.progress import COMPILING, OnProgress, untold
from gyrodrift.result_table import ResultTable
from gyrodrift.session.checks.stated import AS_WRITTEN, ReadingOptions
from gyrodrift.tune.provenance import TuningProvenance, read_provenance

COMPILED_SAMPLES = 100
"""Samples of the run that compiles a method."""

CURVE_POINTS = 300
PLOTTED = 24
"""Of more sessions than this, curves are kept of the first of each folder only."""


class ParamsFrom(Enum):
    """Where the parameters come from that a method runs with."""

    DEFAULTS = "defaults"
    CONFIG = "config"
    TRAINING = "training"


@dataclass(frozen=True, slots=True)
class ConfigFile:
    """The config that was given: its name, the SHA-256 of its content, the filters it has parameters of.

    tuning
        Where `tune` found them; None where the file does not say.
    """

    name: str
    sha256: str
    filters: frozenset[str]
    tuning: TuningProvenance | None = None


def config_file(path: Path, filters: Iterable[str]) -> ConfigFile:
    """What a comparison tells of a config that has parameters of these filters."""
    return ConfigFile(str(path), digest_of(path), frozenset(filters), read_provenance(path))


@dataclass(frozen=True, slots=True)
class ComparisonRequest:
    """What is to be compared.

    paths, stills
        The sessions, and those of them, or more, that did not move.
    train
        Sessions to tune on; without any nothing is tuned.
    iterations, seed
        Of the search for each method.
    config
        Where parameters of the methods come from that are not their defaults.
    reading
        What a person states of columns and units.
    """

    paths: Sequence[Path]
    methods: Sequence[Method]
    train: Sequence[Path] = ()
    stills: frozenset[Path] = frozenset()
    iterations: int = 3000
    seed: int = 0
    config: ConfigFile | None = None
    jobs: int = 1
    progress: OnProgress = untold
    reading: ReadingOptions = AS_WRITTEN


@dataclass(frozen=True, slots=True)
class Entry:
    """A row of the comparison: a method with the parameters it ran with.

    trained_on
        SHA-256 of the sessions that these parameters were tuned on.
    """

    method: Method
    params: Params
    source: ParamsFrom = ParamsFrom.DEFAULTS
    trained_on: frozenset[str] = frozenset()

    @property
    def is_tuned(self) -> bool:
        """In this comparison."""
        return self.source is ParamsFrom.TRAINING

    @property
    def title(self) -> str:
        """For people."""
        source = {ParamsFrom.TRAINING: ["tuned"], ParamsFrom.CONFIG: ["by config"]}.get(self.source, [])
        return ", ".join([self.method.title, *source, *["offline"] * self.method.is_offline])


@dataclass(frozen=True, slots=True)
class ComparedSession:
    """A session with a score for every entry, in their order; `curves` have a yaw for each, where it is plotted.

    uncertainties
        Likewise; None of an entry that states none.
    """

    session: SessionSummary
    folder: str
    scores: tuple[Score, ...]
    uncertainties: tuple[Uncertainty | None, ...]
    curves: YawCurves | None = None


@dataclass(frozen=True, slots=True, repr=False)
class Comparison(ResultTable):
    """Result of a comparison: every method with its parameters, and its score on every session.

    missing
        Methods that could not run, since their packages are not installed.
    train, trained_on
        Names of the sessions that the tuned entries were tuned on, after that of their folder; and the sessions.
    config
        The file that was given; None where none was.
    notes, seconds
        What should be known before believing it, a sentence each, and how long it took.
    """

    entries: tuple[Entry, ...]
    missing: tuple[Method, ...]
    sessions: tuple[ComparedSession, ...]
    train: tuple[str, ...]
    trained_on: tuple[SessionSummary, ...]
    config: ConfigFile | None
    iterations: int
    seed: int
    notes: tuple[str, ...]
    seconds: float

    def __repr__(self) -> str:
        return f"Comparison({len(self.entries)} methods, {len(self.sessions)} sessions)"

    def columns(self) -> dict[str, list[Any]]:
        """Methods, the least mean E first: mean E in deg, NE in deg/min, PI in deg², largest error in deg."""
        means = [self.means[row] for row in self.ranked]
        return {
            "method": [self.entries[row].title for row in self.ranked],
            "e_deg": [mean.e_deg for mean in means],
            "ne": [mean.ne for mean in means],
            "pi_deg2": [mean.pi_deg2 for mean in means],
            "worst_deg": [mean.worst_deg for mean in means],
        }

    @property
    def means(self) -> tuple[Score, ...]:
        """Over all sessions, by entry."""
        return _means(self.sessions)

    @property
    def folders(self) -> dict[str, tuple[Score, ...]]:
        """Over the sessions of each folder, by entry."""
        names = dict.fromkeys(one.folder for one in self.sessions)
        return {name: _means([one for one in self.sessions if one.folder == name]) for name in names}

    @property
    def mean_uncertainties(self) -> tuple[Uncertainty | None, ...]:
        """Over all sessions, by entry."""
        return tuple(map(mean_uncertainty, zip(*(one.uncertainties for one in self.sessions), strict=True)))

    @property
    def ranked(self) -> tuple[int, ...]:
        """Numbers of the entries, the one with the least mean E first."""
        return tuple(sorted(range(len(self.entries)), key=lambda at: self.means[at].e_deg))

    @property
    def streaming(self) -> tuple[int, ...]:
        """Those of them that a device can run, the best first."""
        return tuple(at for at in self.ranked if not self.entries[at].method.is_offline)

    def seen_by(self, entry: Entry) -> list[ComparedSession]:
        """The sessions that the parameters of an entry were tuned on."""
        return [one for one in self.sessions if one.session.digest in entry.trained_on]


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
    _compile(present, asked.progress)
    train = _loaded(asked)
    found = tuned(present, train, asked.iterations, asked.seed, asked.jobs, asked.progress) if train else {}
    digests = frozenset(one.description.digest for one in train)
    entries = [_given(method, asked.config) for method in present]
    entries += [_tuned_entry(entry, found[entry.method.key], digests) for entry in entries if entry.method.key in found]
    sessions, trained_in = _run(asked, entries), folder_names(asked.train)
    return Comparison(
        entries=tuple(entries),
        missing=tuple(method for method in asked.methods if not method.is_installed),
        sessions=tuple(sessions),
        train=tuple(f"{folder}/{path.stem}" for folder, path in zip(trained_in, asked.train, strict=True)),
        trained_on=tuple(one.description for one in train),
        config=asked.config,
        iterations=asked.iterations,
        seed=asked.seed,
        notes=tuple(_notes(asked, entries, sessions, train)),
        seconds=time.monotonic() - begun_s,
    )


def _compile(methods: Sequence[Method], progress: OnProgress) -> None:
    """Compile every method by a run over a second of rest; processes that are forked later have the compiled code."""
    progress(COMPILING, 0, 0)
    t_s = np.arange(COMPILED_SAMPLES) / COMPILED_SAMPLES
    for method in methods:
        for function in filter(None, (method.run, method.sigma)):
            function(t_s, np.zeros(COMPILED_SAMPLES), method.defaults)


def _given(method: Method, config: ConfigFile | None) -> Entry:
    """A method as it comes: with its defaults, or with what a config says."""
    if config is None or method.key not in config.filters:
        return Entry(method, method.defaults)
    tuning = config.tuning
    is_tuned = tuning is not None and tuning.filter == method.key
    seen = frozenset(session.sha256 for session in tuning.training) if tuning is not None and is_tuned else frozenset()
    return Entry(method, method.defaults, ParamsFrom.CONFIG, seen)


def _tuned_entry(given: Entry, params: Params, digests: frozenset[str]) -> Entry:
    """Where the search ended above the parameters that were there, these know the sessions that they were tuned on."""
    known = given.trained_on if params == given.params else frozenset()
    return Entry(given.method, params, ParamsFrom.TRAINING, digests | known)


def _source(path: Path, asked: ComparisonRequest) -> Source:
    return Source(path, path in asked.stills, reading=asked.reading)


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
    known = {key: one.seeing(reference.beside) if one.seeing else one for key, one in known.items()}
    yaws_deg = [known[key].run(loaded.t_s, reference.rate_dps, params) for key, params in work.runs]
    return ComparedSession(
        session=loaded.description,
        folder=work.folder,
        scores=tuple(score_of(reference, yaw_deg) for yaw_deg in yaws_deg),
        uncertainties=tuple(
            _uncertainty(known[key], params, loaded, yaw_deg)
            for (key, params), yaw_deg in zip(work.runs, yaws_deg, strict=True)
        ),
        curves=yaw_curves(loaded, yaws_deg, CURVE_POINTS) if work.is_plotted else None,
    )


def _uncertainty(method: Method, params: Params, loaded: LoadedSession, yaw_deg: Floats) -> Uncertainty | None:
    if method.sigma is None:
        return None
    reference = loaded.reference
    return uncertainty_of(reference, yaw_deg, method.sigma(loaded.t_s, reference.rate_dps, params))


def _notes(
    asked: ComparisonRequest,
    entries: Sequence[Entry],
    compared: Sequence[ComparedSession],
    train: Sequence[LoadedSession],
) -> Iterator[str]:
    sessions, trained_on = [one.session for one in compared], [one.description for one in train]
    yield from (warning for session in sessions for warning in session.warnings)
    digests = {session.digest for session in trained_on}
    both = [session.name for session in sessions if session.digest in digests]
    if both:
        yield f"the tuned rows flatter: they were tuned on {', '.join(both)} too, which they are scored on"
    for entry in entries:
        known = [session.name for session in sessions if session.digest in entry.trained_on]
        if known and entry.source is ParamsFrom.CONFIG and asked.config is not None:
            yield (
                f"the row {entry.title} flatters: {asked.config.name} was tuned on {', '.join(known)}, "
                "which it is scored on"
            )
    counting = " and of ".join(one.method.title for one in entries if one.is_tuned and one.method.counts_samples)
    if counting and rates_differ([session.sample_rate_hz for session in [*sessions, *trained_on]]):
        yield f"sample rates differ: tuned steps of {counting} count samples of one rate"
