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
        "These effects are real but no causes: each is below the size at which it begins to matter, and moves the yaw "
        f"of the integrated rate by less than {number(NEGLIGIBLE_DEG)}° on average over a session. "
        "<code>rig.yaml</code> leaves them as they are."
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
    head = headings(["effect", "size", "fits nearly as well", "probability", "yaw error it causes", "in the rig"])
    caption = "Size: the best, and those that fit nearly as well. Probability: that it acts."
    return section("Real, but negligible", paragraph(words), table(caption, head, rows))
