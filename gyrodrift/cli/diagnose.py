"""Explain the gap between a simulated rig and recordings of the real rig.

Names the effect that is missing from the simulator, or says that no known effect explains the gap. Gives its size, and
how far the effect closes the gap. DIR gets gap.json, report.html, and rig.yaml with the effect added.
"""

import argparse
import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from gyrodrift.cli import inputs, options
from gyrodrift.cli.parser import unknown
from gyrodrift.cli.written import tell_page
from gyrodrift.io.files import check_writable, write_whole
from gyrodrift.io.installation import need_packages
from gyrodrift.report.provenance import Provenance, UsedFile, date_now, set_name
from gyrodrift.session.checks.given import columns_or_none
from gyrodrift.session.checks.stated import ReadingOptions
from gyrodrift.values.errors import UsageError, visible

EXAMPLES = """\
gyrodrift diagnose sessions --check
gyrodrift diagnose sessions --rig my-rig.yaml --out report
gyrodrift diagnose real --baseline their-simulator --export gazebo --export json --out report
"""
EXPORTS = ("gazebo", "kalibr", "mujoco", "json")
"""Formats of `gyrodrift.diagnose.export.files`, which is imported late."""

if TYPE_CHECKING:
    from gyrodrift.diagnose.options import DiagnoseOptions
    from gyrodrift.diagnose.stages import DiagnosisRequest


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("paths", type=Path, nargs="+", metavar="PATH", help="session with an encoder, or a folder")
    parser.add_argument("--rig", type=Path, metavar="RIG.yaml", help="rig file of the simulator (default: shipped)")
    parser.add_argument("--out", type=Path, metavar="DIR", help="folder for the results (needed unless --check)")
    parser.add_argument(
        "--check",
        action="store_true",
        help="say in seconds what these recordings can show, what differs from the baseline, and what to record "
        "instead; simulate and write nothing",
    )
    parser.add_argument(
        "--withhold",
        type=_withheld,
        action="append",
        default=[],
        metavar="EFFECT",
        help="exclude an effect from the candidates (repeatable; default: none)",
    )
    parser.add_argument(
        "--baseline",
        type=Path,
        action="append",
        default=[],
        metavar="PATH",
        help="sessions of another day or simulator: explain the difference to them (repeatable; default: none)",
    )
    parser.add_argument(
        "--baseline-columns",
        metavar="SPEC",
        help="columns, units and signs of the --baseline tables, if the options --columns, --rate-unit, --time-unit, "
        "--accel-unit and --flip do not hold for them (default: like PATH)",
    )
    parser.add_argument(
        "--export",
        choices=EXPORTS,
        action="append",
        default=[],
        help="write the diagnosed effects for another simulator to DIR/export (repeatable; default: none)",
    )
    options.add_jobs_option(parser)
    options.add_reading_options(parser)
    options.add_damage_option(parser)


def run(arguments: argparse.Namespace) -> int:
    """Diagnose; 0 if all files are written, whatever the verdict."""
    if arguments.baseline_columns is not None and not arguments.baseline:
        raise UsageError("--baseline-columns: needs --baseline PATH, whose columns it states")
    if arguments.check:
        return _check(arguments)
    if arguments.out is None:
        raise UsageError("--out: needs a folder for the results; --check works without")
    check_writable(arguments.out)
    with options.progress_of(arguments, {}) as waiting:
        waiting.report(options.PACKAGES, 0, 0)
        need_packages("diagnose")
        options.load_effects()
        from gyrodrift.diagnose.diagnosis import diagnose
        from gyrodrift.diagnose.export.files import FOLDER, export_line, exports_of, write_exports
        from gyrodrift.diagnose.export.files import NAMES as EXPORT_NAMES
        from gyrodrift.diagnose.report.files import NAMES, summary, write_files
        from gyrodrift.diagnose.report.page import report_html
        from gyrodrift.diagnose.stages import REPORT, SHARES
    with options.progress_of(arguments, {} if arguments.baseline else SHARES) as progress:
        outputs = [*NAMES, *(f"{FOLDER}/{name}" for name in EXPORT_NAMES)]
        request = _given(arguments, [arguments.out / name for name in outputs]).request(progress.report)
        diagnosis = diagnose(request)
        progress.report(REPORT, 0, 0)
        exports = exports_of(diagnosis, arguments.export)
        write_files(arguments.out, diagnosis)
        write_exports(arguments.out, exports)
        page = report_html(diagnosis, arguments.out, _provenance(arguments, request), exports)
    write_whole(arguments.out / "report.html", [page])
    for remark in diagnosis.remarks:
        print(f"gyrodrift: note: {remark}", file=sys.stderr)
    for line in summary(diagnosis):
        print(visible(line))
    for export in exports:
        print(visible(f"export: {export_line(export)}"))
    tell_page(arguments.out / "report.html", is_quiet=arguments.quiet)
    return 0


def _check(arguments: argparse.Namespace) -> int:
    """Print what the recordings can show."""
    need_packages("diagnose")
    from gyrodrift.diagnose.before import check_before
    from gyrodrift.io.progress import ignore_progress

    for line in check_before(_given(arguments, []).request(ignore_progress)):
        print(visible(line))
    return 0


def _given(arguments: argparse.Namespace, outputs: list[Path]) -> "DiagnoseOptions":
    """Options of the diagnosis; `outputs` are files that no input may be."""
    from gyrodrift.diagnose.options import DiagnoseOptions

    spec = columns_or_none(arguments.baseline_columns)
    return options.record_of(
        DiagnoseOptions,
        arguments,
        withhold=frozenset(arguments.withhold),
        jobs=options.processes(arguments.jobs),
        inputs=inputs.input_options(arguments, outputs),
        baseline_reading=None if spec is None else ReadingOptions(spec),
    )


def _provenance(arguments: argparse.Namespace, request: "DiagnosisRequest") -> Provenance:
    """Provenance of the page; its config is the rig."""
    from gyrodrift.evaluation.dataset import digest_of
    from gyrodrift.simulation.sessions import rig_yaml

    uses = {"diagnosed": request.paths, "baseline": request.baseline}
    used = [
        UsedFile(str(path), digest_of(path), use if arguments.baseline else "")
        for use, paths in uses.items()
        for path in paths
    ]
    return Provenance(
        set_name=set_name(arguments.paths),
        command=shlex.join(arguments.command_line),
        date=date_now(),
        sessions=used,
        config=f"the rig {arguments.rig}" if arguments.rig else "the shipped rig, config/rig.yaml",
        config_text=rig_yaml(request.rig),
    )


def _withheld(text: str) -> str:
    """Check an argument of `--withhold`, the name of an effect.

    Raises
    ------
    UsageError
        If there is no such effect.
    """
    from firmware_sim.effects.catalogue import CATALOGUE

    options.load_effects()
    if text not in CATALOGUE:
        raise unknown("effect", f"--withhold {text}", CATALOGUE)
    return text
