"""Compare methods: tune them if requested, then run them over every session."""

import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass
from enum import Enum
from pathlib import Path
from typing import Any

import numpy as np

from gyrodrift.compare.methods.method import Method, Params
from gyrodrift.compare.methods.registry import by_key
from gyrodrift.compare.tuning import TuningProvenance, read_provenance, tuned
from gyrodrift.evaluation.dataset import (
    LoadedSession,
    SessionSummary,
    Source,
    YawCurves,
    digest_of,
    folder_names,
    load_with_reference,
    rates_differ,
    yaw_curves,
)
from gyrodrift.evaluation.score import Score, Uncertainty, mean_score, mean_uncertainty, score_of, uncertainty_of
from gyrodrift.filters.registry import FILTERS
from gyrodrift.io.parallel import workers
from gyrodrift.io.progress import COMPILING, OnProgress, ignore_progress
from gyrodrift.io.result_table import ResultTable
from gyrodrift.session.checks.stated import AS_WRITTEN, ReadingOptions, session_as_stated
from gyrodrift.values.arrays import Floats

COMPILED_SAMPLES = 100
"""Samples of the run that compiles a method."""

CURVE_POINTS = 300
PLOTTED = 24
"""Most sessions with curves; with more sessions, only the first of each folder has curves: chosen."""


class ParamsFrom(Enum):
    """Source of the parameters of a method."""

    DEFAULTS = "defaults"
    CONFIG = "config"
    TRAINING = "training"


@dataclass(frozen=True, slots=True)
class ConfigFile:
    """A config: its name, the SHA-256 of its content, and the filters with parameters in it.

    tuning
        Provenance of the parameters; None without it.
    """

    name: str
    sha256: str
    filters: frozenset[str]
    tuning: TuningProvenance | None = None


def config_file(path: Path, filters: Iterable[str]) -> ConfigFile:
    """Description of a config with parameters of these filters."""
    return ConfigFile(str(path), digest_of(path), frozenset(filters), read_provenance(path))


@dataclass(frozen=True, slots=True)
class ComparisonRequest:
    """Request for a comparison.

    paths, stills
        Sessions, and sessions in which the device did not move.
    train
        Sessions to tune on; empty for no tuning.
    iterations, seed
        Evaluations and seed of the search for each method.
    config
        Config with parameters of the filters; None for the defaults.
    reading
        Options for columns and units.
    """

    paths: Sequence[Path]
    methods: Sequence[Method]
    train: Sequence[Path] = ()
    stills: frozenset[Path] = frozenset()
    iterations: int = 3000
    seed: int = 0
    config: ConfigFile | None = None
    jobs: int = 1
    progress: OnProgress = ignore_progress
    reading: ReadingOptions = AS_WRITTEN


@dataclass(frozen=True, slots=True)
class Entry:
    """A row of the comparison: a method with its parameters.

    trained_on
        SHA-256 of the training sessions of the parameters.
    """

    method: Method
    params: Params
    source: ParamsFrom = ParamsFrom.DEFAULTS
    trained_on: frozenset[str] = frozenset()

    @property
    def is_tuned(self) -> bool:
        """Whether the parameters were tuned in this comparison."""
        return self.source is ParamsFrom.TRAINING

    @property
    def title(self) -> str:
        """Name with the source of the parameters."""
        source = {ParamsFrom.TRAINING: ["tuned"], ParamsFrom.CONFIG: ["by config"]}.get(self.source, [])
        if self.source is ParamsFrom.DEFAULTS and self.params != self.method.defaults:  # beside a row by config
            source = ["defaults"]
        return ", ".join([self.method.title, *source, *["offline"] * self.method.is_offline])


@dataclass(frozen=True, slots=True)
class ComparedSession:
    """A session with a score for every entry, in the order of the entries.

    uncertainties
        Uncertainty for every entry; None for an entry without one.
    curves
        Yaw for every entry; None for a session that is not plotted.
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
        Methods whose packages are not installed.
    train, trained_on
        Names of the training sessions, with their folders; and the sessions.
    config
        The config; None without one.
    notes, seconds
        Warnings, a sentence each, and the duration, s.
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
        """Means over all sessions, by entry."""
        return _means(self.sessions)

    @property
    def folders(self) -> dict[str, tuple[Score, ...]]:
        """Means over the sessions of each folder, by entry."""
        names = dict.fromkeys(session.folder for session in self.sessions)
        return {name: _means([session for session in self.sessions if session.folder == name]) for name in names}

    @property
    def mean_uncertainties(self) -> tuple[Uncertainty | None, ...]:
        """Means over all sessions, by entry."""
        return tuple(map(mean_uncertainty, zip(*(session.uncertainties for session in self.sessions), strict=True)))

    @property
    def ranked(self) -> tuple[int, ...]:
        """Rows of the entries in order of mean E."""
        return tuple(sorted(range(len(self.entries)), key=lambda row: self.means[row].e_deg))

    @property
    def streaming(self) -> tuple[int, ...]:
        """Rows of the entries that run in real time, in order of mean E."""
        return tuple(row for row in self.ranked if not self.entries[row].method.is_offline)

    def trained_on_by(self, entry: Entry) -> list[ComparedSession]:
        """Compared sessions among the training sessions of an entry."""
        return [session for session in self.sessions if session.session.digest in entry.trained_on]


def _means(sessions: Sequence[ComparedSession]) -> tuple[Score, ...]:
    return tuple(mean_score(scores) for scores in zip(*(session.scores for session in sessions), strict=True))


def compare(request: ComparisonRequest) -> Comparison:
    """Run every installed method over every session.

    Raises
    ------
    DataError
        If a session cannot be read or has no reference.
    """
    begun_s = time.monotonic()
    applicable = _applicable(request)
    installed = [method for method in applicable if method.is_installed]
    _compile(installed, request.progress)
    train = _loaded(request)
    entries = _entries(request, installed, train)
    sessions = _run(request, entries)
    return Comparison(
        entries=tuple(entries),
        missing=tuple(method for method in applicable if not method.is_installed),
        sessions=tuple(sessions),
        train=tuple(
            f"{folder}/{path.stem}" for folder, path in zip(folder_names(request.train), request.train, strict=True)
        ),
        trained_on=tuple(loaded.description for loaded in train),
        config=request.config,
        iterations=request.iterations,
        seed=request.seed,
        notes=tuple(_notes(request, entries, sessions, train)),
        seconds=time.monotonic() - begun_s,
    )


def _applicable(request: ComparisonRequest) -> list[Method]:
    """Methods for which all sessions have the columns; sessions to tune on need no yaw of the device."""
    columns = [_columns_of(path, request) for path in (*request.train, *request.paths)]
    has_axes = all(has for has, _, _ in columns)
    has_device_yaw = all(has for _, has, _ in columns[len(request.train) :])
    has_aids = any(has for _, _, has in columns[len(request.train) :])
    chosen = [method for method in request.methods if has_axes or not method.needs_axes]
    chosen = [method for method in chosen if has_aids or not method.needs_aids]
    return [method for method in chosen if has_device_yaw or not method.needs_device_yaw]


def _compile(methods: Sequence[Method], progress: OnProgress) -> None:
    """Compile every method by a run over a second of rest, before processes are forked: they inherit the code."""
    progress(COMPILING, 0, 0)
    t_s = np.arange(COMPILED_SAMPLES) / COMPILED_SAMPLES
    for method in methods:
        for function in (
            ()
            if method.needs_axes or method.needs_device_yaw or method.needs_aids
            else filter(None, (method.run, method.sigma))
        ):
            function(t_s, np.zeros(COMPILED_SAMPLES), method.defaults)


def _entries(request: ComparisonRequest, methods: Sequence[Method], train: Sequence[LoadedSession]) -> list[Entry]:
    """Rows with the given parameters, then the defaults of a config's filters, then rows with tuned parameters."""
    entries = [_given_entry(method, request.config) for method in methods]
    by_config = [entry for entry in entries if entry.source is ParamsFrom.CONFIG]
    defaults = [Entry(entry.method, asdict(FILTERS[entry.method.key].params())) for entry in by_config]
    entries += [default for default, entry in zip(defaults, by_config, strict=True) if default.params != entry.params]
    if not train:
        return entries
    best = tuned(methods, train, request.iterations, request.seed, request.jobs, request.progress)
    digests = frozenset(loaded.description.digest for loaded in train)
    tunable = [entry for entry in entries if entry.method.key in best and entry not in defaults]
    return entries + [_tuned_entry(entry, best[entry.method.key], digests) for entry in tunable]


def _given_entry(method: Method, config: ConfigFile | None) -> Entry:
    """A method with the parameters of the config, or with its defaults."""
    if config is None or method.key not in config.filters:
        return Entry(method, method.defaults)
    tuning = config.tuning
    if tuning is None or tuning.filter != method.key:
        return Entry(method, method.defaults, ParamsFrom.CONFIG)
    digests = frozenset(session.sha256 for session in tuning.training)
    return Entry(method, method.defaults, ParamsFrom.CONFIG, digests)


def _tuned_entry(given: Entry, params: Params, digests: frozenset[str]) -> Entry:
    """Method with tuned parameters; parameters that the search did not change keep their earlier training sessions."""
    earlier = given.trained_on if params == given.params else frozenset()
    return Entry(given.method, params, ParamsFrom.TRAINING, digests | earlier)


def _source(path: Path, request: ComparisonRequest) -> Source:
    return Source(path, path in request.stills, reading=request.reading)


def _columns_of(path: Path, request: ComparisonRequest) -> tuple[bool, bool, bool]:
    """Whether a session has three rates and accelerations, the device's own yaw, and second sources."""
    session = session_as_stated(path, request.reading)
    has_axes = session.gyro_dps is not None and session.accel_mps2 is not None
    return has_axes, session.device_yaw_deg is not None, bool(session.aids)


def _loaded(request: ComparisonRequest) -> list[LoadedSession]:
    """Sessions to tune on."""
    sessions = []
    for done, path in enumerate(request.train):
        request.progress("sessions to tune on", done, len(request.train))
        sessions.append(load_with_reference(_source(path, request)))
    return sessions


def _run(request: ComparisonRequest, entries: Sequence[Entry]) -> list[ComparedSession]:
    folders = folder_names(request.paths)
    firsts = {folders.index(name) for name in folders}
    is_plotted = [len(folders) <= PLOTTED or index in firsts for index in range(len(folders))]
    works = [
        _Work(_source(path, request), folder, plotted)
        for path, folder, plotted in zip(request.paths, folders, is_plotted, strict=True)
    ]
    compared = []
    request.progress("sessions", 0, len(works))
    runs = [(entry.method.key, entry.params) for entry in entries]
    with workers(min(request.jobs, len(works)), runs) as pool:
        for done, session in enumerate(pool.map(_compared, works), 1):
            request.progress("sessions", done, len(works))
            compared.append(session)
    return compared


@dataclass(frozen=True, slots=True)
class _Work:
    """Task for a worker process: a session on which the methods run."""

    source: Source
    folder: str
    is_plotted: bool


def _compared(runs: Sequence[tuple[str, Params]], work: _Work) -> ComparedSession:
    loaded = load_with_reference(work.source)
    reference = loaded.reference
    by_name = {
        key: method.on(reference.axes, reference.auxiliary, reference.device_yaw, reference.aids)
        for key, method in by_key().items()
    }
    yaws_deg = [by_name[key].run(loaded.t_s, reference.rate_dps, params) for key, params in runs]
    return ComparedSession(
        session=loaded.description,
        folder=work.folder,
        scores=tuple(score_of(reference, yaw_deg) for yaw_deg in yaws_deg),
        uncertainties=tuple(
            _uncertainty(by_name[key], params, loaded, yaw_deg)
            for (key, params), yaw_deg in zip(runs, yaws_deg, strict=True)
        ),
        curves=yaw_curves(loaded, yaws_deg, CURVE_POINTS) if work.is_plotted else None,
    )


def _uncertainty(method: Method, params: Params, loaded: LoadedSession, yaw_deg: Floats) -> Uncertainty | None:
    if method.sigma is None:
        return None
    reference = loaded.reference
    return uncertainty_of(reference, yaw_deg, method.sigma(loaded.t_s, reference.rate_dps, params))


def _notes(
    request: ComparisonRequest,
    entries: Sequence[Entry],
    compared: Sequence[ComparedSession],
    train: Sequence[LoadedSession],
) -> Iterator[str]:
    """Warnings of the sessions, then warnings about scores on training sessions."""
    sessions, trained_on = [row.session for row in compared], [loaded.description for loaded in train]
    yield from (warning for session in sessions for warning in session.warnings)
    digests = {session.digest for session in trained_on}
    shared = [session.name for session in sessions if session.digest in digests]
    if shared:
        yield f"tuned rows are too optimistic: they were tuned and scored on {', '.join(shared)}"
    for entry in entries:
        shared = [session.name for session in sessions if session.digest in entry.trained_on]
        if shared and entry.source is ParamsFrom.CONFIG and request.config is not None:
            yield (
                f"the row {entry.title} is too optimistic: {request.config.name} was tuned on "
                f"sessions that are scored here: {', '.join(shared)}"
            )
    counting = [entry.method.title for entry in entries if entry.is_tuned and entry.method.counts_samples]
    if counting and rates_differ([session.sample_rate_hz for session in [*sessions, *trained_on]]):
        yield f"sample rates differ: tuned parameters of {' and '.join(counting)} hold for one sample rate"
