"""Explain the gap between a simulated rig and recordings of the real one.

Says where they part, which effect of the catalogue is missing from the rig (or that none explains it), how large it is,
and how far adding it closes the gap. DIR gets gap.json, report.html, and rig.yaml with the effect switched on.
"""

import argparse
import shlex
import sys
from pathlib import Path

from gyrodrift.cli import options
from gyrodrift.errors import UsageError
from gyrodrift.files import check_inputs_kept, check_writable, write_whole


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("paths", type=Path, nargs="+", metavar="PATH", help="session with an encoder, or a folder")
    parser.add_argument("--rig", type=Path, metavar="RIG.yaml", help="the simulator as it stands (default: shipped)")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder for the results")
    parser.add_argument(
        "--withhold", action="append", default=[], metavar="EFFECT", help="leave it out of the candidates"
    )
    parser.add_argument(
        "--baseline",
        type=Path,
        action="append",
        default=[],
        metavar="PATH",
        help="sessions of the same device from another day or bench: explain the difference to them",
    )
    parser.add_argument("--jobs", type=int, metavar="N", help="processes (default: as many as there are processors)")
    parser.add_argument("--cluster", metavar="ADDRESS", help="replay on a Dask cluster, such as tcp://host:8786")


def run(arguments: argparse.Namespace) -> int:
    """Diagnose; 0 when everything is written, whatever the verdict."""
    options.positive("--jobs", arguments.jobs)
    check_writable(arguments.out)
    options.hold_product_threads()
    options.need_packages("diagnose", "matplotlib", "numba", "scipy")
    from firmware_sim.effects.catalogue import CATALOGUE
    from firmware_sim.rig import load_rig
    from firmware_sim.yaml_file import FileError
    from gyrodrift.diagnose.diagnosis import diagnose
    from gyrodrift.diagnose.report.files import NAMES, summary, write_files
    from gyrodrift.diagnose.report.page import report_html
    from gyrodrift.diagnose.stages import DiagnosisRequest
    from gyrodrift.progress import Progress
    from gyrodrift.session.files import session_paths

    for name in arguments.withhold:
        if name not in CATALOGUE:
            raise UsageError(f"--withhold {name}: there is no such effect; there are {', '.join(CATALOGUE)}")
    try:
        rig = load_rig(arguments.rig)
    except FileError as error:
        raise UsageError(str(error)) from error
    paths = session_paths(arguments.paths)
    baseline = session_paths(arguments.baseline) if arguments.baseline else []
    rigs = [arguments.rig] if arguments.rig else []
    check_inputs_kept([arguments.out / name for name in NAMES], [*paths, *baseline, *rigs])
    jobs = options.processes(arguments.jobs)
    with Progress(sys.stderr) as progress:
        withheld = frozenset(arguments.withhold)
        diagnosis = diagnose(
            DiagnosisRequest(
                paths,
                rig,
                withheld,
                jobs,
                arguments.cluster,
                progress.evaluated,
                baseline,
            )
        )
    write_files(arguments.out, diagnosis)
    page = report_html(diagnosis, arguments.out, shlex.join(arguments.command_line))
    write_whole(arguments.out / "report.html", [page])
    for remark in diagnosis.remarks:
        print(f"gyrodrift: note: {remark}", file=sys.stderr)
    for line in summary(diagnosis):
        print(line)
    return 0
