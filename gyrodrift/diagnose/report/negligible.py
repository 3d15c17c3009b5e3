"""Negligible effects in a report: a short list with their change of yaw."""

from gyrodrift.diagnose.inference.verdict import NEGLIGIBLE_DEG
from gyrodrift.diagnose.report.text import in_rig, interval, number, quiet, size, stated
from gyrodrift.diagnose.result import Diagnosis
from gyrodrift.html.html import headings, paragraph, section, table, text


def negligible(diagnosis: Diagnosis) -> str:
    """The section of the negligible effects; empty without such effects."""
    items = diagnosis.verdict.negligible
    if not items:
        return ""
    words = (
        "These effects are real but no causes: each is below the size at which it matters, and changes integrated "
        f"yaw by less than {number(NEGLIGIBLE_DEG)}° in the mean of a session. <code>rig.yaml</code> leaves them as "
        "they are."
    )
    rows = []
    for item in items:
        first = item.cause.parameters[0]
        named = f"{text(item.cause.effect.name)} {quiet(text(first.name))}"
        probability = text(stated(item.cause.probability))
        in_rig_now = in_rig(item.cause) or "not in it"
        rows.append(
            [
                named,
                size(first.value, first.unit),
                interval(first),
                probability,
                f"{number(item.yaw_deg, 2)}°",
                in_rig_now,
            ]
        )
    head = headings(["effect", "size", "possible sizes (95 %)", "probability", "yaw error it causes", "in the rig"])
    caption = "Size: the most probable one. Probability: that the effect acts."
    return section("Real, but negligible", paragraph(words), table(caption, head, rows))
