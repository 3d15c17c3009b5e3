"""The report of a diagnosis: one HTML file for a person, with the verdict first, and then all that it rests on."""

from pathlib import Path

from gyrodrift.diagnose.report.causes import causes
from gyrodrift.diagnose.report.features import features
from gyrodrift.diagnose.report.head import verdict
from gyrodrift.diagnose.report.method import calibration, how_it_was_done
from gyrodrift.diagnose.report.negligible import negligible
from gyrodrift.diagnose.report.next_steps import detectable, next_steps
from gyrodrift.diagnose.report.residuals import residuals
from gyrodrift.diagnose.result import Diagnosis
from gyrodrift.html.html import page


def report_html(diagnosis: Diagnosis, folder: Path, command: str = "") -> str:
    """The page of a diagnosis whose files stand in a folder, with the command that made it."""
    body = [
        verdict(diagnosis),
        negligible(diagnosis),
        features(diagnosis),
        residuals(diagnosis),
        causes(diagnosis),
        detectable(diagnosis),
        calibration(diagnosis),
        next_steps(diagnosis, folder),
        how_it_was_done(diagnosis, command),
    ]
    return page("Sim-to-real gap", body)
