"""Exports for other simulators in a report: their files, and what a format cannot express."""

from collections.abc import Sequence

from gyrodrift.diagnose.export.files import FOLDER
from gyrodrift.diagnose.export.formats import FormatExport
from gyrodrift.html.html import headings, paragraph, section, table, text


def exported(exports: Sequence[FormatExport]) -> str:
    """The section of the exports; empty without exports."""
    if not exports:
        return ""
    words = (
        "Causes with a probability of 0.5 or more, and the measured noise and bias. A baseline has noise and bias of "
        "its own; then the files have the difference. An effect that a format cannot express is not in its file."
    )
    head = headings(["format", "files", "effects in it", "effects that it cannot express"])
    return section("Exports", paragraph(words), table("Files for other simulators.", head, list(map(_row, exports))))


def _row(export: FormatExport) -> list[str]:
    files = ", ".join(f"<code>{text(FOLDER)}/{text(name)}</code>" for name in export.files)
    missing = "; ".join(f"{text(name)}: {text(why)}" for name, why in export.not_expressed.items())
    return [text(export.format), files, text(", ".join(export.expressed) or "none"), missing or "none"]
