"""An attitude horizon of text: the ground as braille dots, as a person on the device sees it.

With the right side down the horizon rises to the right; with the nose up it sinks.
"""

from math import cos, radians, sin

from rich.text import Text

from gyrodrift.io.text_chart import DOTS

SHOWN_PITCH_DEG = 45.0
"""Pitch that moves the horizon to the edge, deg."""

GROUND, MARK = "yellow", "bold"
WING = 3
"""Characters of the mark of the device on each side."""


def horizon(roll_deg: float, pitch_deg: float, rows: int) -> list[Text]:
    """Rows of text; two columns a row make it square.

    Roll is positive with the right side down, pitch with the nose down.
    """
    columns = 2 * rows
    return [_row(row, rows, columns, radians(roll_deg), pitch_deg) for row in range(rows)]


def _row(row: int, rows: int, columns: int, roll_rad: float, pitch_deg: float) -> Text:
    text = Text("".join(_cell(column, row, rows, columns, roll_rad, pitch_deg) for column in range(columns)), GROUND)
    if row == rows // 2:
        middle = columns // 2
        text = Text.assemble(text[: middle - WING], ("─" * WING + "┼" + "─" * (WING - 1), MARK), text[middle + WING :])
    return text


def _cell(column: int, row: int, rows: int, columns: int, roll_rad: float, pitch_deg: float) -> str:
    """Character with the dots that are ground."""
    bits = 0
    for dot_row, line in enumerate(DOTS):
        for dot_column, bit in enumerate(line):
            x = 2 * column + dot_column + 0.5 - columns
            y = 2 * rows - (4 * row + dot_row + 0.5)
            height = (y * cos(roll_rad) - x * sin(roll_rad)) / (2 * rows)
            bits |= bit if height < pitch_deg / SHOWN_PITCH_DEG else 0
    return chr(0x2800 + bits) if bits else " "
