"""The next steps in a report, with commands to copy."""

import shlex
from pathlib import Path

from gyrodrift.diagnose.inference.verdict import Kind
from gyrodrift.diagnose.report.files import PROFILE
from gyrodrift.diagnose.report.text import in_rig
from gyrodrift.diagnose.result import Diagnosis
from gyrodrift.report.page import Section


def next_steps(diagnosis: Diagnosis, folder: Path) -> Section:
    """The section of the next steps; `folder` is the folder of the report."""
    causes = [cause for cause in diagnosis.verdict.causes if cause.is_adopted]
    names = {
        "rig": "rig.yaml",
        "simulated": "simulated",
        "again": "again",
        "profile": PROFILE,
        "combined": "more",
    }
    values = {
        **{key: shlex.quote(str(folder / name)) for key, name in names.items()},
        "tuned": folder / "tuned.yaml",
        "has_profile": diagnosis.next_profile_yaml is not None,
        "has_contradictions": bool(diagnosis.contradictions),
        "new": [cause.effect.name for cause in causes if not in_rig(cause)],
        "changed": [cause.effect.name for cause in causes if in_rig(cause)],
        "undecided": [cause.effect.name for cause in diagnosis.verdict.causes if not cause.is_adopted],
        "is_open": diagnosis.verdict.kind is Kind.PARTLY or not diagnosis.verdict.gap.is_closed,
    }
    return Section("diagnose/report/templates/next_steps.html", values, "What to do next")
