"""The report of a diagnosis as an HTML page: first the verdict, then the results that it is derived from."""

import shlex
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from gyrodrift.diagnose.export.formats import FormatExport
from gyrodrift.diagnose.inference.verdict import Kind
from gyrodrift.diagnose.report import text
from gyrodrift.diagnose.report.features import features
from gyrodrift.diagnose.report.head import verdict
from gyrodrift.diagnose.report.residuals import residuals
from gyrodrift.diagnose.report.tables import calibration, detectable, exported, glossary, negligible, sessions
from gyrodrift.diagnose.report.text import in_rig
from gyrodrift.diagnose.result import Diagnosis
from gyrodrift.diagnose.what_next import FILE as PROFILE
from gyrodrift.report.page import Section, page
from gyrodrift.report.provenance import Provenance, provenance


def causes(diagnosis: Diagnosis) -> Section:
    """The section of the causes."""
    heading = "Which effect explains it" if diagnosis.verdict.where else "Which sets of effects are possible"
    return Section("diagnose/report/templates/causes.html", {"diagnosis": diagnosis, "words": text}, heading)


def report_html(diagnosis: Diagnosis, folder: Path, made: Provenance, exports: Sequence[FormatExport] = ()) -> str:
    """The page of a diagnosis; `folder` is the folder of its files."""
    details = [
        negligible(diagnosis),
        features(diagnosis),
        residuals(diagnosis),
        causes(diagnosis),
        detectable(diagnosis),
        calibration(diagnosis),
        exported(exports),
        sessions(diagnosis),
        glossary(),
        provenance(made),
    ]
    folded = [replace(section, is_folded=True) for section in details if section is not None]
    sections = [verdict(diagnosis, made.set_name), next_steps(diagnosis, folder), *folded]
    return page(f"{made.set_name}: recordings and simulator".removeprefix(": "), sections)


def next_steps(diagnosis: Diagnosis, folder: Path) -> Section:
    """The next steps, with commands to copy; `folder` is the folder of the report."""
    causes = [cause for cause in diagnosis.verdict.causes if cause.is_adopted]
    names = {"rig": "rig.yaml", "simulated": "simulated", "again": "again", "profile": PROFILE, "combined": "more"}
    values = {
        **{key: shlex.quote(str(folder / name)) for key, name in names.items()},
        "tuned": folder / "tuned.yaml",
        "diagnosis": diagnosis,
        "new": [cause.effect.name for cause in causes if not in_rig(cause)],
        "changed": [cause.effect.name for cause in causes if in_rig(cause)],
        "undecided": [
            item.effect.name for item in diagnosis.verdict.causes if not (item.is_adopted or item.is_withdrawn)
        ],
        "withdrawn": [cause.effect.name for cause in diagnosis.verdict.causes if cause.is_withdrawn],
        "is_open": diagnosis.verdict.kind is Kind.PARTLY or not diagnosis.verdict.gap.is_closed,
    }
    return Section("diagnose/report/templates/next_steps.html", values, "What to do next")
