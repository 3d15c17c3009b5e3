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
from gyrodrift.io.files import check_inputs_kept, check_writable, write_whole
from gyrodrift.values.errors import UsageError, visible

EXAMPLES = """\
gyrodrift diagnose sessions --out report
gyrodrift diagnose sessions --rig my-rig.yaml --out report
gyrodrift diagnose real --baseline their-simulator --export gazebo --export json --out report
"""
EXPORTS = ("gazebo", "kalibr", "mujoco", "json")
"""Formats of `gyrodrift.diagnose.export.files`, which is imported late."""

if TYPE_CHECKING:
    from firmware_sim.rig import Rig
    from gyrodrift.report.provenance import Provenance
    from gyrodrift.session.checks.stated import ReadingOptions


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("paths", type=Path, nargs="+", metavar="PATH", help="session with an encoder, or a folder")
    parser.add_argument("--rig", type=Path, metavar="RIG.yaml", help="rig file of the simulator (default: shipped)")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder for the results")
    parser.add_argument(
        "--withhold",
        type=options.withheld,
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
    options.add_columns_option(parser)
    options.add_unit_options(parser)
    options.add_cluster_option(parser, "replay")
    options.add_damage_option(parser)


def run(arguments: argparse.Namespace) -> int:
    """Diagnose; 0 if all files are written, whatever the verdict."""
    if arguments.baseline_columns is not None and not arguments.baseline:
        raise UsageError("--baseline-columns: needs --baseline PATH, whose columns it states")
    check_writable(arguments.out)
    options.hold_product_threads()
    with options.progress_of(arguments, {}) as waiting:
        waiting.report(options.PACKAGES, 0, 0)
        from gyrodrift.io.installation import need_packages

        need_packages("diagnose", "numba", "scipy")
        from gyrodrift.diagnose.report.page import report_html
        from gyrodrift.diagnose.stages import REPORT, SHARES, DiagnosisRequest
    from firmware_sim.rig import load_rig
    from firmware_sim.yaml_file import FileError
    from gyrodrift.diagnose.diagnosis import diagnose
    from gyrodrift.diagnose.export.files import FOLDER, export_line, exports_of, write_exports
    from gyrodrift.diagnose.export.files import NAMES as EXPORT_NAMES
    from gyrodrift.diagnose.report.files import NAMES, summary, write_files
    from gyrodrift.session.files import session_paths

    try:
        rig = load_rig(arguments.rig)
    except FileError as error:
        raise UsageError(str(error)) from error
    paths = session_paths(arguments.paths)
    baseline = session_paths(arguments.baseline) if arguments.baseline else []
    rigs = [arguments.rig] if arguments.rig else []
    outputs = [*NAMES, *(f"{FOLDER}/{name}" for name in EXPORT_NAMES)]
    check_inputs_kept([arguments.out / name for name in outputs], [*paths, *baseline, *rigs])
    inputs.check_damage([*paths, *baseline], allow_damage=arguments.allow_damage)
    jobs = options.processes(arguments.jobs)
    with options.progress_of(arguments, {} if arguments.baseline else SHARES) as progress:
        withheld = frozenset(arguments.withhold)
        diagnosis = diagnose(
            DiagnosisRequest(
                paths,
                rig,
                withheld,
                jobs,
                arguments.cluster,
                progress.report,
                baseline,
                reading=inputs.reading(arguments),
                baseline_reading=_baseline_reading(arguments),
                is_rig_stated=arguments.rig is not None,
            )
        )
        progress.report(REPORT, 0, 0)
        exports = exports_of(diagnosis, arguments.export)
        write_files(arguments.out, diagnosis)
        write_exports(arguments.out, exports)
        page = report_html(diagnosis, arguments.out, _provenance(arguments, rig), exports)
    write_whole(arguments.out / "report.html", [page])
    for remark in diagnosis.remarks:
        print(f"gyrodrift: note: {remark}", file=sys.stderr)
    for line in summary(diagnosis):
        print(visible(line))
    for export in exports:
        print(visible(f"export: {export_line(export)}"))
    return 0


def _baseline_reading(arguments: argparse.Namespace) -> "ReadingOptions":
    """Statements on the baseline: the spec of its own alone, or else those on the sessions."""
    from gyrodrift.columns.spec import columns_of
    from gyrodrift.session.checks.stated import ReadingOptions

    if arguments.baseline_columns is None:
        return inputs.reading(arguments)
    return ReadingOptions(columns_of(arguments.baseline_columns))


def _provenance(arguments: argparse.Namespace, rig: "Rig") -> "Provenance":
    """Provenance of the page; its config is the rig."""
    from gyrodrift.evaluation.dataset import digest_of
    from gyrodrift.report.provenance import Provenance, UsedFile, date_now, set_name
    from gyrodrift.session.files import session_paths
    from gyrodrift.simulation.sessions import rig_yaml

    uses = {"diagnosed": arguments.paths, "baseline": arguments.baseline}
    used = [
        UsedFile(str(path), digest_of(path), use if arguments.baseline else "")
        for use, paths in uses.items()
        for path in (session_paths(paths) if paths else [])
    ]
    return Provenance(
        set_name=set_name(arguments.paths),
        command=shlex.join(arguments.command_line),
        date=date_now(),
        sessions=used,
        config=f"the rig {arguments.rig}" if arguments.rig else "the shipped rig, config/rig.yaml",
        config_text=rig_yaml(rig),
    )
