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
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from gyrodrift.cli import INTERRUPTED, inputs, numbers, options
from gyrodrift.filters.registry import FILTERS
from gyrodrift.io.files import UnreadableError, check_inputs_kept, check_writable, read_ordinary, write_whole
from gyrodrift.values.errors import UsageError, visible

if TYPE_CHECKING:
    from gyrodrift.evaluation.dataset import Source
    from gyrodrift.io.progress import Progress
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
    from gyrodrift.config.model import load_config
    from gyrodrift.firmware.my_gyro import TunedGyro, my_gyro_h

    write_whole(path, [my_gyro_h(TunedGyro.of_config(load_config(config), config.name), path.name)])


EXAMPLES = """\
gyrodrift tune sessions --out my.yaml --report report
gyrodrift tune sessions --out my.yaml --filter restlevel --test bench/monday.mcap
gyrodrift tune sessions --out my.yaml --header my_gyro.h --seeds 3 --jobs 2 --range tau_s=0.01:2
"""


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
        "--filter", choices=tuple(FILTERS), help="tune and write this filter (default: the better of hdr and restlevel)"
    )
    parser.add_argument(
        "--report", type=Path, metavar="DIR", help="folder for report.html and tune.json (default: none)"
    )
    parser.add_argument(
        "--test",
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
        action="append",
        default=[],
        metavar="NAME=LOW:HIGH",
        help="search range of a parameter (repeatable; default: a wide range)",
    )
    options.add_jobs_option(parser)
    options.add_columns_option(parser)
    options.add_unit_options(parser)
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
        from gyrodrift.io.installation import need_packages

        need_packages("tune", "cma", "numba")
        signal.signal(signal.SIGTERM, signal.default_int_handler)  # ends like Ctrl-C, with the best so far
        tuning, was_interrupted = _tuned(arguments, progress)
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


def _tuned(arguments: argparse.Namespace, progress: "Progress") -> "tuple[Tuning, bool]":
    sources, path = _sources(arguments), arguments.out.with_suffix(".progress.npz")
    reports = [arguments.report / name for name in ("tune.json", "report.html")] if arguments.report else []
    check_inputs_kept([arguments.out, path, *reports], [source.path for source in sources])
    inputs.check_damage([source.path for source in sources], allow_damage=arguments.allow_damage)

    from gyrodrift.tune.choice import tune_filters
    from gyrodrift.tune.plans import plans_of
    from gyrodrift.tune.search.journal import Journal
    from gyrodrift.tune.tuning_set import TuningSet, identity

    seeds = tuple(range(arguments.seed, arguments.seed + arguments.seeds))
    plans = plans_of(arguments.filter, arguments.iterations, seeds, arguments.method, arguments.range)
    with TuningSet(sources, arguments.seed, arguments.jobs, arguments.cluster, progress.report) as sessions:
        journal = Journal(path, identity(plans, sessions), is_resumed=arguments.resume)
        tuning, was_interrupted = tune_filters(plans, sessions, journal, progress.report)
    if was_interrupted:
        journal.save()
    else:
        journal.discard()
    return tuning, was_interrupted


def _sources(arguments: argparse.Namespace) -> "list[Source]":
    from gyrodrift.evaluation.dataset import Source, Split
    from gyrodrift.session.files import session_paths

    tests, stills = set(session_paths(arguments.test)), set(session_paths(arguments.still))
    paths = dict.fromkeys([*session_paths([*arguments.paths, *arguments.still]), *sorted(tests)])
    reading = inputs.reading(arguments)
    return [Source(path, path in stills, Split.TEST if path in tests else None, reading) for path in paths]


def _write(arguments: argparse.Namespace, tuning: "Tuning") -> None:
    from gyrodrift.tune.report.files import content, summary, write_config

    words = [word for word in arguments.command_line if word != "--resume"]
    command = shlex.join(words)
    kept = _kept_in(arguments.out)
    write_config(arguments.out, tuning, command)
    if kept:
        _keep(arguments.out, kept)
    if arguments.report is not None:
        from gyrodrift.io.files import write_whole
        from gyrodrift.report.files import write_json
        from gyrodrift.report.provenance import Provenance, date_now, set_name
        from gyrodrift.tune.report.page import report_html

        write_json(arguments.report / "tune.json", content(tuning))
        given = [*arguments.paths, *arguments.still, *arguments.test]
        made = Provenance(set_name(given), command, date_now(), config=f"{arguments.out}, with these parameters:")
        write_whole(arguments.report / "report.html", [report_html(tuning, made)])
    if arguments.header is not None:
        write_header(arguments.header, arguments.out)
    for warning in tuning.warnings:
        print(f"gyrodrift: warning: {warning}", file=sys.stderr)
    written = [f"wrote {path}" for path in (arguments.out, arguments.header) if path is not None]
    for line in [*summary(tuning), *written]:
        print(visible(line))


def _kept_in(out: Path) -> str:
    """Lines of an existing config that tuning keeps: axes, mount and calibration; empty without them."""
    from gyrodrift.config.calibration import CALIBRATION, block_in
    from gyrodrift.config.model import load_config

    try:
        load_config(out)
        text = out.read_text(encoding="utf-8-sig")
        return "".join(block_in(text, key) for key in ("axes", "mount", CALIBRATION))
    except (UsageError, OSError):
        return ""  # an unreadable file is replaced


def _keep(out: Path, block: str) -> None:
    from gyrodrift.config.calibration import with_block
    from gyrodrift.io.files import write_whole

    write_whole(out, [with_block(out.read_text(encoding="utf-8"), block)])
