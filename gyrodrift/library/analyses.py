"""`load_session`, and `tune`, `diagnose` and `compare` as functions over paths, as the commands run them."""

from collections.abc import Iterable, Mapping
from os import PathLike
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from gyrodrift.io.installation import need_packages
from gyrodrift.io.progress import OnProgress, ignore_progress

if TYPE_CHECKING:
    from gyrodrift.compare.comparison import Comparison
    from gyrodrift.diagnose.result import Diagnosis
    from gyrodrift.session.checks.given import InputOptions
    from gyrodrift.session.checks.stated import ReadingOptions
    from gyrodrift.session.session import Session
    from gyrodrift.tune.result import Tuning


def load_session(
    path: str | PathLike[str],
    *,
    columns: str | None = None,
    reference: str | None = None,
    allow_damage: bool = False,
    sample_rate_hz: float = 0.0,
) -> "Session":
    """Load a recorded session (`.mcap`) or a table (`.csv`, `.json` and others) as arrays.

    Parameters
    ----------
    path
        The file.
    columns
        Columns of a table, as in the option `--columns`; None to read them from the header.
    reference
        Topic of a bag or `.mcap` with the reference angle, as in the option `--reference`; None for none.
    allow_damage
        Return the undamaged part of a damaged recording; `session.damage` then has the losses.
    sample_rate_hz
        Rate of the samples, in place of a clock, as in the option `--sample-rate`; 0 for the clock of the session.

    Raises
    ------
    DamagedError
        If it is damaged; `damages` says which samples are lost, and how many seconds.
    DataError
        If it is missing, of an unknown kind, or no session.
    """
    from gyrodrift.session.checks.given import columns_or_none
    from gyrodrift.session.checks.stated import ReadingOptions, session_as_stated

    named = columns_or_none(columns)
    stated = ReadingOptions(named, reference=reference or "", sample_rate_hz=sample_rate_hz)
    return session_as_stated(Path(path), stated, allow_damage=allow_damage)


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
    sample_rate_hz: float = 0.0,
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
    sample_rate_hz
        Rate of the samples, in place of a clock; 0 for the clock of the sessions.

    Raises
    ------
    UsageError
        If a package is missing, or a filter, method or parameter does not exist.
    DataError
        If a session cannot be used.
    """
    need_packages("tune")
    from gyrodrift.tune.options import TuneOptions, run_tuning

    options = TuneOptions(
        _paths(paths),
        tests=_paths(tests),
        stills=_paths(stills),
        filter=filter,
        iterations=iterations,
        seeds=tuple(seeds),
        method=method,
        ranges=[f"{name}={low!r}:{high!r}" for name, (low, high) in (ranges or {}).items()],
        jobs=jobs,
        inputs=_inputs(columns, sample_rate_hz, allow_damage=allow_damage),
    )
    with TemporaryDirectory(prefix="gyrodrift-") as folder:
        tuning, was_interrupted = run_tuning(options, Path(folder) / "progress.npz", on_progress)
    if was_interrupted:  # the command writes the best so far; a program wants the whole tuning or none
        raise KeyboardInterrupt
    return tuning


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
    sample_rate_hz: float = 0.0,
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
    sample_rate_hz
        Rate of the samples, in place of a clock; 0 for the clock of the sessions.

    Raises
    ------
    UsageError
        If a package is missing, the rig file is wrong, or an effect does not exist.
    DataError
        If no session can be used, with the reason for each.
    """
    need_packages("diagnose")
    from gyrodrift.diagnose import diagnosis
    from gyrodrift.diagnose.options import DiagnoseOptions

    options = DiagnoseOptions(
        _paths(paths),
        rig=None if rig is None else Path(rig),
        baseline=_paths(baseline),
        withhold=frozenset(withhold),
        jobs=jobs,
        inputs=_inputs(columns, sample_rate_hz, reference, allow_damage=allow_damage),
        baseline_reading=None if baseline_columns is None else _reading(baseline_columns, sample_rate_hz, reference),
    )
    return diagnosis.diagnose(options.request(on_progress))


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
    sample_rate_hz: float = 0.0,
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
    sample_rate_hz
        Rate of the samples, in place of a clock; 0 for the clock of the sessions.

    Raises
    ------
    UsageError
        If a package is missing, or the config has mistakes.
    DataError
        If a session cannot be read or has no reference.
    """
    need_packages("compare")
    from gyrodrift.compare import comparison
    from gyrodrift.compare.options import CompareOptions
    from gyrodrift.config.model import load_config

    config_path = None if config is None else Path(config)
    options = CompareOptions(
        _paths(paths),
        train=_paths(train),
        stills=_paths(stills),
        config=config_path,
        blocks={} if config_path is None else load_config(config_path).blocks,
        iterations=iterations,
        seed=seed,
        jobs=jobs,
        inputs=_inputs(columns, sample_rate_hz, allow_damage=allow_damage),
    )
    return comparison.compare(options.request(on_progress))


def _paths(paths: Paths) -> list[Path]:
    return [Path(path) for path in ([paths] if isinstance(paths, str | PathLike) else paths)]


def _inputs(
    columns: str | None, sample_rate_hz: float, reference: str | None = None, *, allow_damage: bool
) -> "InputOptions":
    from gyrodrift.session.checks.given import InputOptions

    return InputOptions(_reading(columns, sample_rate_hz, reference), allow_damage=allow_damage)


def _reading(columns: str | None, sample_rate_hz: float, reference: str | None) -> "ReadingOptions":
    from gyrodrift.session.checks.given import columns_or_none
    from gyrodrift.session.checks.stated import ReadingOptions

    return ReadingOptions(columns_or_none(columns), reference=reference or "", sample_rate_hz=sample_rate_hz)
