"""What acts and costs nothing, in a report: a short list, with what each costs in yaw."""

from gyrodrift.diagnose.inference.verdict import NEGLIGIBLE_DEG
from gyrodrift.diagnose.report.text import in_rig, interval, number, quiet, size
from gyrodrift.diagnose.result import Diagnosis
from gyrodrift.html.html import headings, paragraph, section, table, text


def negligible(diagnosis: Diagnosis) -> str:
    """The section; nothing where there is none."""
    found = diagnosis.verdict.negligible
    if not found:
        return ""
    words = (
        "These effects are real, and are no causes: each is smaller than what begins to matter, and moves the yaw of "
        f"the integrated rate by less than {number(NEGLIGIBLE_DEG)}° in the mean over a session. <code>rig.yaml</code> "
        "is not changed by them."
    )
    rows = []
    for one in found:
        first = one.cause.parameters[0]
        named = f"{text(one.cause.effect.name)} {quiet(text(first.name))}"
        probability = f"{one.cause.probability:.2f}"
        in_rig_now = in_rig(one.cause) or "not in it"
        rows.append(
            [
                named,
                size(first.value, first.unit),
                interval(first),
                probability,
                f"{number(one.yaw_deg, 2)}°",
                in_rig_now,
            ]
        )
    head = headings(["effect", "size", "interval", "probability", "costs, yaw", "in the rig"])
    return section("Seen, and negligible", paragraph(words), table("What they would cost.", head, rows))
