"""Run the filter of serve over a recorded session, and write its input and its state for each sample as CSV.

Samples are skipped and counted if their time does not advance or their rate is not finite. The calibration of --config
is applied first, or else the calibration in the session. The result is a session too: the first columns are t_device_s
and rate_dps, the input of the filter. The columns after them:
"""

import argparse
import os
import stat
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from math import nan
from operator import attrgetter
from pathlib import Path
from typing import Any, TextIO

from gyrodrift.cli import configs, inputs, options
from gyrodrift.cli.written import samples_text, tell_written
from gyrodrift.config.model import Config
from gyrodrift.filters.beginning import beginning_of
from gyrodrift.filters.registry import FILTERS
from gyrodrift.filters.run import FilterRun
from gyrodrift.io.files import check_kept, write_whole
from gyrodrift.io.progress import OnProgress, counted
from gyrodrift.session.aids import aids_by_row
from gyrodrift.session.calibrated import applied_scale_sigmas, device_of, with_config
from gyrodrift.session.session import FilterSample, Session
from gyrodrift.session.tables.write import Row, write_rows, written_ending
from gyrodrift.values.errors import DataError, GyrodriftError, visible
from gyrodrift.values.sample import Attitude

CORRECTION = "correction_deg"
COMMON_COLUMNS = ("bias_dps", "bias_sigma_dps", "rest_probability", "confidence", "yaw_deg", "yaw_sigma_deg")
ATTITUDE_COLUMNS = Attitude._fields
THREE_AXIS_COLUMNS = (*COMMON_COLUMNS, *ATTITUDE_COLUMNS)

EXAMPLES = """\
gyrodrift filter session.mcap --out yaw.csv
gyrodrift filter session.mcap --config my.yaml | head
gyrodrift info yaw.csv                                 the result is a session too
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    columns = [f"  with {name}: {', '.join((*described.columns, CORRECTION))}" for name, described in FILTERS.items()]
    columns.append(f"  on three axes: {', '.join((*THREE_AXIS_COLUMNS, CORRECTION))}")
    parser.description = "\n".join([f"{parser.description}".rstrip(), *columns])
    parser.add_argument("session", type=Path, metavar="SESSION", help="recorded session (.mcap or .csv)")
    options.add_filter_options(parser, "YAML with a filter and its parameters")
    parser.add_argument(
        "--out",
        type=Path,
        metavar="FILE",
        help="file to write: .csv, .json, .jsonl, .parquet or .mcap (default: CSV on stdout)",
    )
    options.add_force_option(parser)
    options.add_damage_option(parser)
    options.add_reading_options(parser)


def run(arguments: argparse.Namespace) -> int:
    """Filter the session; 0 when the result is written."""
    arguments.quiet |= arguments.out is None and not _is_file(sys.stdout)  # a progress bar would disturb a pager
    with options.progress_of(arguments) as progress:
        progress.report(options.PACKAGES, 0, 0)

        if arguments.out is not None:
            read_files = [arguments.session, *([arguments.config] if arguments.config else [])]
            check_kept([arguments.out], read_files, force=arguments.force)
            written_ending(arguments.out, "--out")
        config = configs.chosen_config(arguments)
        progress.report(f"{arguments.session.name} read", 0, 0)
        session = _calibrated_session(arguments, config)
        chosen = config.chosen
        begun = beginning_of(chosen, session.metadata, session.name)
        run = FilterRun(chosen, config.params, arguments.axes or config.axes, config.mount)
        run.use(*(chosen.scaled(config.params, sigma) for sigma in applied_scale_sigmas(session)))
        run.state = begun or run.state
        rejected_before = run.state.rejected
        try:
            _write(arguments.out, session, run, progress.report)
        except (ArithmeticError, ValueError, IndexError) as error:
            if begun is None or isinstance(error, GyrodriftError):
                raise
            raise DataError(f"{session.name}: the filter state in its metadata cannot be continued: {error}") from error
    for name, status in run.aids.items():
        if status.differs:
            print(
                visible(f"gyrodrift: {session.name}: {name} is left out at the end: {status.differs}"), file=sys.stderr
            )
    if run.state.rejected:
        skipped = f"{samples_text(run.state.rejected)} skipped (time or rate)"
        print(visible(f"gyrodrift: {session.name}: {skipped}"), file=sys.stderr)
    if arguments.out is not None:
        accepted = len(session.t_device_s) - (run.state.rejected - rejected_before)
        tell_written(arguments.out, samples_text(accepted), is_quiet=arguments.quiet)
    return 0


def _write(out: Path | None, session: Session, run: FilterRun, progress: OnProgress) -> None:
    samples = list(session.filter_samples())
    has_axes = any(run.has_axes(sample[2]) for sample in samples)
    columns = THREE_AXIS_COLUMNS if has_axes else run.filter.columns
    names = ["t_device_s", "rate_dps", *columns, CORRECTION]
    rows = rows_of(session, samples, run, _columns(run) if has_axes else attrgetter(*columns))
    counted_rows = counted("samples", rows, len(session.t_device_s), progress, lambda _: 1)
    if out is None:
        sys.stdout.writelines(csv_lines(names, counted_rows))
        sys.stdout.flush()
    elif written_ending(out, "--out") == ".csv":
        write_whole(out, csv_lines(names, counted_rows))
    else:
        write_rows(out, names, counted_rows)


def _is_file(stream: TextIO) -> bool:
    try:
        return stat.S_ISREG(os.fstat(stream.fileno()).st_mode)
    except OSError:
        return False


def csv_lines(names: Sequence[str], rows: Iterator[Row]) -> Iterator[str]:
    """The header and a line per row; floats have all their digits."""
    yield f"{','.join(names)}\n"
    for row in rows:
        yield f"{','.join(map(repr, row))}\n"


def rows_of(
    session: Session, samples: Iterable[FilterSample], run: FilterRun, columns: Callable[[Any], Sequence[float]]
) -> Iterator[Row]:
    """A row per accepted sample; the filter is told of the restarts of the session.

    Raises
    ------
    DataError
        At the end, if more samples were skipped than accepted.
    """
    accepted, restarts_s = 0, frozenset(session.restarts_s)
    aids = aids_by_row(session.aids or ())
    for index, sample in enumerate(samples):
        if sample[0] in restarts_s:
            run.gap(has_restarted=True)
        if run.step(*sample):
            accepted += 1
            for aid in aids.get(index, ()):
                run.aid(aid)
            yield (*sample[:2], *columns(run.state), run.correction_deg)
    rejected = run.state.rejected
    if rejected > accepted:
        raise DataError(
            f"{session.name}: {rejected} of {rejected + accepted} samples have no rate, or a time that is "
            "not later than the previous time; the rest is too little for a yaw"
        )


def _columns(run: FilterRun) -> Callable[[Any], tuple[float, ...]]:
    """Function from the state to `THREE_AXIS_COLUMNS`; without attitude before the first acceleration."""
    common, attitude = attrgetter(*COMMON_COLUMNS), attrgetter(*ATTITUDE_COLUMNS)
    missing = [nan] * len(ATTITUDE_COLUMNS)
    return lambda state: (*common(state), *(missing if run.three_axes is None else attitude(run.attitude())))


def _calibrated_session(arguments: argparse.Namespace, config: Config) -> Session:
    """Load and check a session, and apply the calibration of the config, or else its own, to its rates.

    Raises
    ------
    DataError
        If its numbers contradict their column or unit.
    """
    path, calibration = arguments.session, config.calibration
    session = inputs.checked_session(path, arguments)
    if calibration is not None and not calibration.is_for(device_of(session)):
        reason = f"the calibration is for {calibration.device_id} and is not applied"
        inputs.print_warning(f"{path}: is from device {device_of(session)}; {reason}")
    return with_config(session, calibration)
