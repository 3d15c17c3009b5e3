"""What a report says before its verdict: facts of the rig that cannot be so, the baseline, and doubts."""

from gyrodrift.diagnose.report.text import number
from gyrodrift.diagnose.result import Diagnosis
from gyrodrift.html.html import paragraph, text, warnings

OF_BASELINE = "baseline: "
"""How remarks on the recordings of a baseline begin."""

DIGITS = 5
"""Counts per turn are whole numbers of up to so many."""

FACTS = {
    "encoder_cpr": "an encoder of {}, the recordings show {}",
    "dps_per_lsb": "rates in steps of {}, the recordings show {}",
    "range_dps": "a range of {}, the recordings reach {}",
    "turn_ratio": "an encoder of {}, the gyro agrees with {}",
}
"""What the rig states, and what the recordings show instead."""

PUT_RIGHT = (
    "Where the recordings show the counts per turn or the step of the rates, everything below uses those values, and "
    "<code>rig.yaml</code> states them."
)


def against(diagnosis: Diagnosis) -> str:
    """Facts of the rig that the recordings contradict, in a box; nothing where there are none."""
    if not diagnosis.contradictions:
        return ""
    said = [f"{one.fact}: {one.says}" for one in diagnosis.contradictions]
    return warnings("The rig file contradicts the recordings", said) + paragraph(PUT_RIGHT)


def headline_of(diagnosis: Diagnosis, otherwise: str) -> str:
    """The first of them as a headline, with both numbers; something else where there is none."""
    first = next(iter(diagnosis.contradictions), None)
    if first is None:
        return otherwise
    shown = "none such" if first.sessions is None else number(first.sessions, DIGITS)
    stated = f"{number(first.rig, DIGITS)} {first.unit}"
    return f"The rig states {FACTS[first.fact].format(stated, shown)}"


def baseline(diagnosis: Diagnosis) -> str:
    """What the recordings are held against beside the rig; nothing where there is no baseline."""
    said = [one.removeprefix(OF_BASELINE) for one in diagnosis.remarks if one.startswith(OF_BASELINE)]
    if not said:
        return ""
    return paragraph(
        "<b>Compared with a baseline.</b> What the baseline recordings show already is taken out: a difference to the "
        f"simulator that both sets have does not count. About the baseline: {text('; '.join(said))}."
    )


def doubts(diagnosis: Diagnosis) -> str:
    """What limits the result, in a box."""
    linear = diagnosis.linear_model
    disagrees = [f"a linear model of the rate error {linear.says}"] if linear.agrees is False else []
    remarks = [one for one in diagnosis.remarks if not one.startswith(OF_BASELINE)]
    return warnings("Before believing it", [*remarks, *disagrees])
