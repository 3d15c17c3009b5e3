"""`tune`, `diagnose` and `compare` as functions over paths, as the commands run them."""

from collections.abc import Iterable, Mapping
from os import PathLike
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from gyrodrift.io.progress import OnProgress, ignore_progress
from gyrodrift.values.errors import UsageError

if TYPE_CHECKING:
    from gyrodrift.compare.comparison import Comparison
    from gyrodrift.diagnose.result import Diagnosis
    from gyrodrift.evaluation.dataset import Source
    from gyrodrift.session.checks.stated import ReadingOptions
    from gyrodrift.tune.result import Tuning
    from gyrodrift.tune.tuning import Plan

Paths = str | PathLike[str] | Iterable[str | PathLike[str]]
"""A session, a folder of sessions, or several of them."""


def tune(
    paths: Paths,
    *,
    filter: str | None = None,  # noqa: A002 - as the config and the command call it
    tests: Paths = (),
    stills: Paths = (),
    iterations: int = 3000,
    seeds: Iterable[int] = (0,),
    method: str | None = None,
    ranges: Mapping[str, tuple[float, float]] | None = None,
    jobs: int | None = None,
    on_progress: OnProgress = ignore_progress,
    allow_damage: bool = False,
    columns: str | None = None,
) -> "Tuning":
    """Tune filters on sessions with an encoder; `result.filter` is the best filter, `result.params` its parameters.

    Parameters
    ----------
    paths
        Sessions or folders of sessions.
    filter
        Name of the filter to tune; None tunes HDR and restlevel, and gives the better one on held-out sessions.
    tests, stills
        Sessions to hold out, and sessions in which the device did not move; both may be among `paths` or not.
    iterations, seeds, method
        Evaluations of the cost in each search, the seed of each search, and the search method as in `--method`.
    ranges
        Search range of a parameter, (low, high) in its own unit, by name.
    jobs
        Threads; None for one per processor.
    on_progress
        Called with the name of the search, the evaluations so far, and their total.
    allow_damage
        Use the undamaged part of a damaged recording.
    columns
        Columns of tables, as in the option `--columns`; None to read them from the header.

    Raises
    ------
    UsageError
        If a package is missing, or a filter, method or parameter does not exist.
    DataError
        If a session cannot be used.
    """
    _check_filter(filter)
    _need("tune", "cma", "numba")
    from gyrodrift.evaluation.dataset import Source, Split
    from gyrodrift.tune.plans import plans_of
    from gyrodrift.tune.search.methods import METHODS

    if method is not None and method not in METHODS:
        raise UsageError(f"method {method!r}: there is no such method; there are {', '.join(METHODS)}")
    texts = [f"{name}={low!r}:{high!r}" for name, (low, high) in (ranges or {}).items()]
    plans = plans_of(filter, _positive("iterations", iterations), _seeds(seeds), method, texts)
    test_paths, still = set(_sessions(tests)), set(_sessions(stills))
    every = dict.fromkeys([*_sessions(paths), *sorted(still), *sorted(test_paths)])
    _check_damage(every, allow_damage=allow_damage)
    named = _reading(columns)
    sources = [Source(path, path in still, Split.TEST if path in test_paths else None, named) for path in every]
    return _tuned(plans, sources, jobs, on_progress)


def diagnose(
    paths: Paths,
    *,
    rig: str | PathLike[str] | None = None,
    baseline: Paths = (),
    withhold: Iterable[str] = (),
    jobs: int = 1,
    on_progress: OnProgress = ignore_progress,
    allow_damage: bool = False,
    columns: str | None = None,
    baseline_columns: str | None = None,
    reference: str | None = None,
) -> "Diagnosis":
    """Explain the gap between a simulated rig and recordings; `result.verdict` names the missing effect.

    Parameters
    ----------
    paths, baseline
        Sessions with an encoder; earlier sessions of the same device, to explain the difference to them.
    rig
        Rig file of the simulator; None for the shipped rig.
    withhold
        Effects excluded from the candidates.
    jobs
        Processes.
    on_progress
        Called with the name of the stage, how much is done, and the total, 0 if unknown.
    allow_damage
        Use the undamaged part of a damaged recording.
    columns, baseline_columns
        Columns of tables, as in the option `--columns`; None to read them from the header. The baseline has those of
        `columns` unless `baseline_columns` states its own.
    reference
        Topic of bags and `.mcap` files with the reference angle, as in the option `--reference`; None for none.

    Raises
    ------
    UsageError
        If a package is missing, the rig file is wrong, or an effect does not exist.
    DataError
        If no session can be used, with the reason for each.
    """
    _need("diagnose", "numba", "scipy")
    from firmware_sim.effects.catalogue import CATALOGUE
    from firmware_sim.rig import load_rig
    from firmware_sim.yaml_file import FileError
    from gyrodrift.diagnose import diagnosis
    from gyrodrift.diagnose.stages import DiagnosisRequest

    withheld = frozenset(withhold)
    for name in sorted(withheld - CATALOGUE.keys()):
        raise UsageError(f"withhold {name!r}: there is no such effect; there are {', '.join(CATALOGUE)}")
    try:
        simulator = load_rig(None if rig is None else Path(rig))
    except FileError as error:
        raise UsageError(str(error)) from error
    of_baseline = _sessions(baseline)
    jobs = _positive("jobs", jobs)
    request = DiagnosisRequest(
        _sessions(paths),
        simulator,
        withheld,
        jobs,
        None,
        on_progress,
        of_baseline,
        reading=_reading(columns, reference),
        baseline_reading=_reading(columns if baseline_columns is None else baseline_columns, reference),
        is_rig_stated=rig is not None,
    )
    _check_damage([*request.paths, *of_baseline], allow_damage=allow_damage)
    return diagnosis.diagnose(request)


def compare(
    paths: Paths,
    *,
    train: Paths = (),
    stills: Paths = (),
    config: str | PathLike[str] | None = None,
    iterations: int = 3000,
    seed: int = 0,
    jobs: int = 1,
    on_progress: OnProgress = ignore_progress,
    allow_damage: bool = False,
    columns: str | None = None,
) -> "Comparison":
    """Run every installed method over sessions with an encoder; `result.entries` and `result.means` correspond.

    Parameters
    ----------
    paths, train, stills
        Sessions; sessions to tune every method on, none for no tuning; sessions in which the device did not move.
    config
        Config with parameters of the filters; None for their defaults.
    iterations, seed
        Evaluations and seed of the search for each method.
    jobs
        Processes.
    on_progress
        Called with the name of the stage, how much is done, and the total, 0 if unknown.
    allow_damage
        Use the undamaged part of a damaged recording.
    columns
        Columns of tables, as in the option `--columns`; None to read them from the header.

    Raises
    ------
    UsageError
        If a package is missing, or the config has mistakes.
    DataError
        If a session cannot be read or has no reference.
    """
    _need("compare", "cma", "numba", "scipy")
    from gyrodrift.compare import comparison
    from gyrodrift.compare.methods.registry import methods
    from gyrodrift.config.model import load_config

    given = None if config is None else load_config(Path(config))
    still = _sessions(stills)
    request = comparison.ComparisonRequest(
        paths=list(dict.fromkeys([*_sessions(paths), *still])),
        methods=methods(given.blocks if given else {}),
        train=_sessions(train),
        stills=frozenset(still),
        iterations=_positive("iterations", iterations),
        seed=_seeds([seed])[0],
        config=None if config is None or given is None else comparison.config_file(Path(config), given.blocks),
        jobs=_positive("jobs", jobs),
        progress=on_progress,
        reading=_reading(columns),
    )
    _check_damage([*request.paths, *request.train], allow_damage=allow_damage)
    return comparison.compare(request)


def _tuned(plans: "tuple[Plan, ...]", sources: "list[Source]", jobs: int | None, on_progress: OnProgress) -> "Tuning":
    from gyrodrift.tune.choice import tune_filters
    from gyrodrift.tune.search.journal import Journal
    from gyrodrift.tune.tuning_set import TuningSet, identity

    with (
        TemporaryDirectory(prefix="gyrodrift-") as folder,
        TuningSet(sources, plans[0].seeds[0], jobs, None, on_progress) as sessions,
    ):
        journal = Journal(Path(folder) / "progress.npz", identity(plans, sessions), is_resumed=False)
        tuning, was_interrupted = tune_filters(plans, sessions, journal, on_progress)
    if was_interrupted:  # the command writes the best so far; a program wants the whole tuning or none
        raise KeyboardInterrupt
    return tuning


def _sessions(paths: Paths) -> list[Path]:
    from gyrodrift.session.files import session_paths

    given = [paths] if isinstance(paths, str | PathLike) else paths
    return session_paths([Path(path) for path in given])


def _check_damage(paths: Iterable[Path], *, allow_damage: bool) -> None:
    from gyrodrift.session.damage import DamagedError
    from gyrodrift.session.files import damages_of

    damages = [] if allow_damage else damages_of(paths)
    if damages:
        raise DamagedError(damages)


def _reading(spec: str | None, reference: str | None = None) -> "ReadingOptions":
    from gyrodrift.columns.spec import columns_of
    from gyrodrift.session.checks.stated import ReadingOptions

    return ReadingOptions(None if spec is None else columns_of(spec), reference=reference or "")


def _need(function: str, *packages: str) -> None:
    from gyrodrift.io.installation import need_packages

    need_packages(function, *packages)


def _check_filter(name: str | None) -> None:
    from gyrodrift.filters.registry import FILTERS

    if name is not None and name not in FILTERS:
        raise UsageError(f"filter {name!r}: there is no such filter; there are {', '.join(FILTERS)}")


def _seeds(seeds: Iterable[int]) -> tuple[int, ...]:
    numbers = tuple(seeds)
    if not numbers or min(numbers) < 0:
        raise UsageError(f"seeds {numbers}: expected whole numbers from 0, at least one")
    return numbers


def _positive(name: str, value: int) -> int:
    if value < 1:
        raise UsageError(f"{name} {value}: expected a whole number from 1")
    return value
