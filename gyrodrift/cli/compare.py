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
from gyrodrift.io.files import check_inputs_kept, check_writable
from gyrodrift.values.errors import visible

if TYPE_CHECKING:
    from gyrodrift.compare.comparison import Comparison, ComparisonRequest
    from gyrodrift.io.progress import Progress

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
    options.add_columns_option(parser)
    options.add_unit_options(parser)


def run(arguments: argparse.Namespace) -> int:
    """Compare; 0 if all files are written."""
    if arguments.out is not None:
        check_writable(arguments.out)
    options.hold_product_threads()
    with options.progress_of(arguments, {} if arguments.train else None) as progress:
        progress.report(options.PACKAGES, 0, 0)
        from gyrodrift.io.installation import need_packages

        need_packages("compare", "cma", "numba", "scipy")
        from gyrodrift.compare.comparison import compare

        signal.signal(signal.SIGTERM, signal.default_int_handler)  # ends the workers too
        request = _request(arguments, progress)
        if arguments.out is not None:
            config = [arguments.config] if arguments.config else []
            written = [arguments.out / name for name in ("compare.json", "report.html")]
            check_inputs_kept(written, [*request.paths, *request.train, *config])
        inputs.check_damage([*request.paths, *request.train], allow_damage=arguments.allow_damage)
        comparison = compare(request)
    _write(arguments, comparison)
    return 0


def _request(arguments: argparse.Namespace, progress: "Progress") -> "ComparisonRequest":
    from gyrodrift.compare.comparison import ComparisonRequest, config_file
    from gyrodrift.compare.methods.registry import methods
    from gyrodrift.session.files import session_paths

    config = configs.loaded_config(arguments.config) if arguments.config else None
    stills = session_paths(arguments.still)
    return ComparisonRequest(
        paths=list(dict.fromkeys([*session_paths(arguments.paths), *stills])),
        methods=methods(config.blocks if config else {}),
        train=session_paths(arguments.train),
        stills=frozenset(stills),
        iterations=arguments.iterations,
        seed=arguments.seed,
        config=config_file(arguments.config, config.blocks) if config else None,
        jobs=options.processes(arguments.jobs),
        progress=progress.report,
        reading=inputs.reading(arguments),
    )


def _write(arguments: argparse.Namespace, comparison: "Comparison") -> None:
    from gyrodrift.compare.report.files import content, summary

    if arguments.out is not None:
        from gyrodrift.compare.report.page import report_html
        from gyrodrift.io.files import write_whole
        from gyrodrift.report.files import write_json
        from gyrodrift.report.provenance import Provenance, date_now, set_name

        command = shlex.join(arguments.command_line)
        made = Provenance(set_name([*arguments.paths, *arguments.still]), command, date_now())
        write_json(arguments.out / "compare.json", content(comparison, command))
        write_whole(arguments.out / "report.html", [report_html(comparison, made)])
    for note in comparison.notes:
        print(f"gyrodrift: note: {note}", file=sys.stderr)
    for line in summary(comparison):
        print(visible(line))
