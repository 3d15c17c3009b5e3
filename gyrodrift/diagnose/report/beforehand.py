"""Boxes and paragraphs about the verdict: contradicted facts of the rig, the baseline, and limits of the result."""

from gyrodrift.diagnose.report.text import number
from gyrodrift.diagnose.result import Diagnosis
from gyrodrift.html.html import paragraph, text, warnings

OF_BASELINE = "baseline: "
"""Prefix of remarks on the recordings of a baseline."""

DIGITS = 5
"""Digits of counts per turn."""

FACTS = {
    "encoder_cpr": "an encoder of {}, the recordings show {}",
    "dps_per_lsb": "rates in steps of {}, the recordings show {}",
    "range_dps": "a range of {}, the recordings reach {}",
    "turn_ratio": "an encoder of {}, the gyro agrees with {}",
}
"""Words for each fact: the value of the rig, and the value of the recordings."""

CORRECTED = (
    "Where the recordings show the counts per turn or the step of the rates, everything below uses those values, and "
    "<code>rig.yaml</code> states them."
)


def against(diagnosis: Diagnosis) -> str:
    """Facts of the rig that the recordings contradict, in a box; empty if there are none."""
    if not diagnosis.contradictions:
        return ""
    warnings_said = [f"{contradiction.fact}: {contradiction.says}" for contradiction in diagnosis.contradictions]
    return warnings("The rig file contradicts the recordings", warnings_said) + paragraph(CORRECTED)


def headline_of(diagnosis: Diagnosis, otherwise: str) -> str:
    """The first contradiction as a headline, with both numbers; `otherwise` if there is none."""
    first = next(iter(diagnosis.contradictions), None)
    if first is None:
        return otherwise
    shown = "none such" if first.sessions is None else number(first.sessions, DIGITS)
    stated = f"{number(first.rig, DIGITS)} {first.unit}"
    return f"The rig states {FACTS[first.fact].format(stated, shown)}"


def baseline(diagnosis: Diagnosis) -> str:
    """The baseline in a paragraph; empty without a baseline."""
    statements = [remark.removeprefix(OF_BASELINE) for remark in diagnosis.remarks if remark.startswith(OF_BASELINE)]
    if not statements:
        return ""
    return paragraph(
        "<b>Compared with a baseline.</b> A difference to the simulator that the baseline recordings show, too, does "
        f"not count. About the baseline: {text('; '.join(statements))}."
    )


def limits(diagnosis: Diagnosis) -> str:
    """Limits of the result in a box."""
    linear = diagnosis.linear_model
    disagrees = [f"a linear model of the rate error {linear.says}"] if linear.agrees is False else []
    remarks = [remark for remark in diagnosis.remarks if not remark.startswith(OF_BASELINE)]
    return warnings("Limits of this result", [*remarks, *disagrees])
