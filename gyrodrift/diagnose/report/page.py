"""The report of a diagnosis as an HTML page: first the verdict, then the results that it is derived from."""

from collections.abc import Sequence
from pathlib import Path

from gyrodrift.diagnose.export.formats import FormatExport
from gyrodrift.diagnose.report.causes import causes
from gyrodrift.diagnose.report.features import features
from gyrodrift.diagnose.report.head import verdict
from gyrodrift.diagnose.report.next_steps import next_steps
from gyrodrift.diagnose.report.residuals import residuals
from gyrodrift.diagnose.report.tables import calibration, detectable, exported, glossary, negligible, sessions
from gyrodrift.diagnose.result import Diagnosis
from gyrodrift.report.page import page
from gyrodrift.report.provenance import Provenance, provenance


def report_html(diagnosis: Diagnosis, folder: Path, made: Provenance, exports: Sequence[FormatExport] = ()) -> str:
    """The page of a diagnosis; `folder` is the folder of its files."""
    sections = [
        verdict(diagnosis, made.set_name),
        negligible(diagnosis),
        features(diagnosis),
        residuals(diagnosis),
        causes(diagnosis),
        detectable(diagnosis),
        exported(exports),
        calibration(diagnosis),
        next_steps(diagnosis, folder),
        glossary(),
        sessions(diagnosis),
        provenance(made),
    ]
    return page(f"{made.set_name}: recordings and simulator".removeprefix(": "), sections)
