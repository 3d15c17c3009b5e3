"""Compare HDR and restlevel with other drift reducers on the same sessions with an encoder.

Prints means over the sessions for each method: E, the mean absolute yaw error, deg; NE, E per minute; PI, the mean
squared error, deg²; and the largest error, deg. All methods integrate by the trapezoidal rule, HDR as published.

Methods run with their defaults. With --train they also run with parameters tuned on those sessions. All have the same
search and the same number of evaluations. --out writes compare.json and report.html.
"""

import argparse
import shlex
import signal
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from gyrodrift.cli import configs, inputs, numbers, options
from gyrodrift.cli.plug_ins import tell_problems
from gyrodrift.cli.written import tell_page
from gyrodrift.io.files import check_writable, write_whole
from gyrodrift.io.installation import need_packages
from gyrodrift.report.numbers import write_json
from gyrodrift.report.provenance import Provenance, date_now, set_name
from gyrodrift.values.errors import visible

if TYPE_CHECKING:
    from gyrodrift.compare.comparison import Comparison

EXAMPLES = """\
gyrodrift compare sessions
gyrodrift compare sessions --config my.yaml --out comparison
gyrodrift compare sessions --train other-sessions --iterations 600 --out comparison
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("paths", type=Path, nargs="+", metavar="PATH", help="session with an encoder, or a folder")
    parser.add_argument(
        "--config",
        type=Path,
        metavar="FILE",
        help="config with parameters of HDR or restlevel (default: their defaults)",
    )
    parser.add_argument(
        "--train",
        type=Path,
        action="append",
        default=[],
        metavar="PATH",
        help="session or folder to tune every method on (repeatable; default: none)",
    )
    options.add_still_option(parser)
    parser.add_argument(
        "--out", type=Path, metavar="DIR", help="folder for compare.json and report.html (default: none)"
    )
    parser.add_argument("--seed", type=numbers.seed, default=0, metavar="N", help="seed of the searches (default 0)")
    options.add_iterations_option(parser, "evaluations of each search, with --train")
    options.add_jobs_option(parser)
    options.add_damage_option(parser)
    options.add_reading_options(parser)


def run(arguments: argparse.Namespace) -> int:
    """Compare; 0 if all files are written."""
    if arguments.out is not None:
        check_writable(arguments.out)
    with options.progress_of(arguments, {} if arguments.train else None) as progress:
        progress.report(options.PACKAGES, 0, 0)
        need_packages("compare")
        tell_problems("gyrodrift.filters")
        from gyrodrift.compare.comparison import compare
        from gyrodrift.compare.options import CompareOptions

        signal.signal(signal.SIGTERM, signal.default_int_handler)  # ends the workers too
        outputs = [arguments.out / name for name in ("compare.json", "report.html")] if arguments.out else []
        given = options.record_of(
            CompareOptions,
            arguments,
            blocks=configs.loaded_config(arguments.config).blocks if arguments.config else {},
            jobs=options.processes(arguments.jobs),
            inputs=inputs.input_options(arguments, outputs),
        )
        comparison = compare(given.request(progress.report))
    _write(arguments, comparison)
    return 0


def _write(arguments: argparse.Namespace, comparison: "Comparison") -> None:
    from gyrodrift.compare.report.files import content, summary

    if arguments.out is not None:
        from gyrodrift.compare.report.page import report_html

        command = shlex.join(arguments.command_line)
        made = Provenance(set_name([*arguments.paths, *arguments.stills]), command, date_now())
        write_json(arguments.out / "compare.json", content(comparison, command))
        write_whole(arguments.out / "report.html", [report_html(comparison, made)])
    for note in comparison.notes:
        print(f"gyrodrift: note: {note}", file=sys.stderr)
    for line in summary(comparison):
        print(visible(line))
    if arguments.out is not None:
        tell_page(arguments.out / "report.html", is_quiet=arguments.quiet)
