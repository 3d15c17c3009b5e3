"""Find filter parameters from recorded sessions with an encoder, and write a config for serve.

Tunes HDR and restlevel, and writes the filter that is better on held-out sessions. If the defaults of a filter are
better than all tuned parameters, the config has these defaults. --filter tunes and writes one filter.

Some sessions are held out as a test. With five sessions or fewer, each session is tested with parameters tuned on the
others. An iteration is one evaluation of the cost over all training sessions. Ctrl-C writes the best parameters so far;
the same command with --resume continues.
"""

import argparse
import shlex
import signal
from pathlib import Path
from typing import TYPE_CHECKING

from gyrodrift.cli import INTERRUPTED, inputs, numbers, options
from gyrodrift.cli.parser import Choices
from gyrodrift.cli.written import tell_page, tell_written
from gyrodrift.config.calibration import CALIBRATION, block_in, with_block
from gyrodrift.config.model import load_config
from gyrodrift.filters.registry import FILTERS
from gyrodrift.firmware.my_gyro import TunedGyro, my_gyro_h
from gyrodrift.io.files import UnreadableError, check_writable, read_ordinary, write_whole
from gyrodrift.io.installation import need_packages
from gyrodrift.report.numbers import write_json
from gyrodrift.report.provenance import Provenance, date_now, set_name
from gyrodrift.values.errors import UsageError, visible

if TYPE_CHECKING:
    from gyrodrift.tune.result import Tuning

MARK = b"Written by gyrodrift "
"""Words in the head of every written header, before the version."""

INCLUDED = ("gyrodrift.h", "gyrodrift_native.h", "math.h", "stdint.h", "string.h")
"""Headers that the library and its includes are found by: a header of this name would be included in their place."""

LONGEST_BYTES = 1 << 20


def check_header(path: Path) -> None:
    """Check that a header can be written, and replaces no file of another origin.

    Raises
    ------
    UsageError
        With what is wrong.
    """
    if path.suffix not in (".h", ".hpp"):
        raise UsageError(f"--header {path}: a header ends in .h")
    if path.name.lower() in INCLUDED:
        raise UsageError(f"--header {path}: {path.name} is a header of the library or of C; choose another name")
    if not path.parent.is_dir():
        raise UsageError(f"--header {path}: there is no folder {path.parent}")
    check_writable(path.parent)
    try:
        content = read_ordinary(path, LONGEST_BYTES).content
    except FileNotFoundError:
        return
    except UnreadableError as error:
        raise UsageError(f"--header {path}: {error}") from error
    if MARK not in content:
        raise UsageError(f"--header {path}: is not from gyrodrift; choose another name")


def write_header(path: Path, config: Path) -> None:
    """Write parameters and calibration of a config."""
    write_whole(path, [my_gyro_h(TunedGyro.of_config(load_config(config), config.name), path.name)])


EXAMPLES = """\
gyrodrift tune sessions --out my.yaml --report report
gyrodrift tune sessions --out my.yaml --filter restlevel --test bench/monday.mcap
gyrodrift tune sessions --out my.yaml --header my_gyro.h --seeds 3 --jobs 2 --range tau_s=0.01:2
"""

COMMON = (
    "--out",
    "--report",
    "--filter",
    "--test",
    "--header",
    "--iterations",
    "--seed",
    "--jobs",
    "--columns",
    "--reference",
    "--resume",
)
"""Options in the short help."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("paths", type=Path, nargs="+", metavar="PATH", help="session with an encoder, or a folder")
    parser.add_argument("--out", type=Path, required=True, metavar="FILE.yaml", help="config to write")
    parser.add_argument(
        "--header",
        type=Path,
        metavar="FILE.h",
        help="header to write for gyrodrift firmware, with the parameters and the calibration (default: none)",
    )
    parser.add_argument(
        "--filter",
        choices=Choices(FILTERS),
        metavar=f"{{{','.join(FILTERS.own)}}}",
        help="tune and write this filter (default: the better of hdr and restlevel)",
    )
    parser.add_argument(
        "--report", type=Path, metavar="DIR", help="folder for report.html and tune.json (default: none)"
    )
    parser.add_argument(
        "--test",
        dest="tests",
        type=Path,
        action="append",
        default=[],
        metavar="PATH",
        help="session to hold out as a test (repeatable; default: drawn by the seed)",
    )
    options.add_still_option(parser)
    parser.add_argument(
        "--seed", type=numbers.seed, default=0, metavar="N", help="seed of split and search (default 0)"
    )
    parser.add_argument(
        "--seeds",
        type=numbers.whole(1000),
        default=1,
        metavar="K",
        help="number of searches, each with its own seed; the best counts (default 1)",
    )
    options.add_iterations_option(parser, "evaluations of each search")
    parser.add_argument(
        "--method",
        choices=("race", "carla", "cma", "de", "random"),
        help="search method: race (automata, then local searches), carla (as published), cma, de or random "
        "(default: carla for hdr and race for restlevel; race with --filter)",
    )
    parser.add_argument(
        "--range",
        dest="ranges",
        action="append",
        default=[],
        metavar="NAME=LOW:HIGH",
        help="search range of a parameter (repeatable; default: a wide range)",
    )
    options.add_jobs_option(parser)
    options.add_reading_options(parser)
    options.add_cluster_option(parser, "evaluate")
    options.add_damage_option(parser)
    parser.add_argument("--resume", action="store_true", help="continue an interrupted run with this --out")


def run(arguments: argparse.Namespace) -> int:
    """Tune; 0 if all files are written."""
    _check_paths(arguments.out, arguments.report)
    if arguments.header is not None:
        check_header(arguments.header)
    with options.progress_of(arguments, {}) as progress:
        progress.report(options.PACKAGES, 0, 0)
        need_packages("tune")
        from gyrodrift.tune.options import TuneOptions, run_tuning

        signal.signal(signal.SIGTERM, signal.default_int_handler)  # ends like Ctrl-C, with the best so far
        journal = arguments.out.with_suffix(".progress.npz")
        reports = [arguments.report / name for name in ("tune.json", "report.html")] if arguments.report else []
        given = options.record_of(
            TuneOptions,
            arguments,
            seeds=tuple(range(arguments.seed, arguments.seed + arguments.seeds)),
            inputs=inputs.input_options(arguments, [arguments.out, journal, *reports]),
        )
        tuning, was_interrupted = run_tuning(given, journal, progress.report, is_resumed=arguments.resume)
    _write(arguments, tuning)
    return INTERRUPTED if was_interrupted else 0


def _check_paths(out: Path, report: Path | None) -> None:
    """Check the paths before an hour of work."""
    if out.suffix not in (".yaml", ".yml"):
        raise UsageError(f"--out {out}: a config ends in .yaml")
    if not out.parent.is_dir():
        raise UsageError(f"--out {out}: there is no folder {out.parent}")
    check_writable(out.parent)
    if report is not None:
        check_writable(report)


def _write(arguments: argparse.Namespace, tuning: "Tuning") -> None:
    from gyrodrift.tune.report.files import content, summary, write_config

    command = shlex.join(word for word in arguments.command_line if word != "--resume")
    kept = _kept_in(arguments.out)
    write_config(arguments.out, tuning, command)
    if kept:
        _keep(arguments.out, kept)
    if arguments.report is not None:
        from gyrodrift.tune.report.page import report_html

        write_json(arguments.report / "tune.json", content(tuning))
        given = [*arguments.paths, *arguments.stills, *arguments.tests]
        made = Provenance(set_name(given), command, date_now(), config=f"{arguments.out}, with these parameters:")
        write_whole(arguments.report / "report.html", [report_html(tuning, made)])
    if arguments.header is not None:
        write_header(arguments.header, arguments.out)
    for warning in tuning.warnings:
        inputs.print_warning(warning)
    for line in summary(tuning):
        print(visible(line))
    kinds = ((arguments.out, f"config of {tuning.filter.name}"), (arguments.header, "header for gyrodrift firmware"))
    for path, contents in kinds:
        if path is not None:
            tell_written(path, contents, is_quiet=arguments.quiet)
    if arguments.report is not None:
        tell_page(arguments.report / "report.html", is_quiet=arguments.quiet)


def _kept_in(out: Path) -> str:
    """Lines of an existing config that tuning keeps: axes, mount and calibration; empty without them."""
    try:
        load_config(out)
        text = out.read_text(encoding="utf-8-sig")
        return "".join(block_in(text, key) for key in ("axes", "mount", CALIBRATION))
    except (UsageError, OSError):
        return ""  # an unreadable file is replaced


def _keep(out: Path, block: str) -> None:
    write_whole(out, [with_block(out.read_text(encoding="utf-8"), block)])
