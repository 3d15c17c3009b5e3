"""Second sources in the columns of a text or a table: headings, speeds, wheels and turn rates.

A cell may be empty, because most sources are slower than the gyro. A heading that stands from line to line is held,
and counts once.
"""

from collections.abc import Mapping, Sequence
from math import isfinite, nan

from gyrodrift.columns.spec import AID_MEANINGS, WHEELS, Column
from gyrodrift.values.aid import Aid

WHEELS_NAME = "wheels"
"""Name of two wheels, which are one source."""


class AidColumns:
    """The second sources among some columns, line by line.

    prefix, names
        Words before each name: the source of the lines, with a point; and names by meaning in place of the labels.
    """

    def __init__(self, columns: Sequence[Column], prefix: str = "", names: Mapping[str, str] | None = None) -> None:
        self._columns = {column.meaning: column for column in columns if column.meaning in AID_MEANINGS}
        stated = {meaning: column.label or meaning for meaning, column in self._columns.items()}
        stated |= dict.fromkeys(WHEELS, WHEELS_NAME)
        if names is not None:  # of a known message, whose labels are no names
            stated = {meaning: names.get(meaning, WHEELS_NAME if meaning in WHEELS else meaning) for meaning in stated}
        self._names = {meaning: prefix + name for meaning, name in stated.items()}
        self._last_deg = nan

    def __bool__(self) -> bool:
        return bool(self._columns)

    def aids_of(self, values: Mapping[str, float]) -> tuple[Aid, ...]:
        """Measurements of a line, whose times count from it; values by meaning, in their units, NaN if missing."""
        numbers = {name: value for name in self._columns if isfinite(value := values.get(name, nan))}
        speed = numbers.get("speed", nan)
        if speed == 0.0 and numbers.get("turn_rate", 0.0) != 0.0:  # it turns on the spot, which is no rest
            del numbers["speed"]
        aids = [self._aid(name, numbers[name]) for name in ("speed", "turn_rate") if name in numbers]
        heading_deg = values.get("heading", nan) if "heading" in self._columns else nan
        if isfinite(heading_deg) and heading_deg != self._last_deg:
            column = self._columns["heading"]
            aids.append(self._aid("heading", heading_deg)._replace(period_deg=column.modulo_deg, speed=speed))
        self._last_deg = heading_deg
        if all(name in numbers for name in WHEELS):
            left_speed, right_speed = (numbers[name] for name in WHEELS)
            aids.append(
                self._aid(WHEELS[0], right_speed - left_speed)._replace(
                    kind="wheels", speed=0.5 * (left_speed + right_speed)
                )
            )
        return tuple(aids)

    def _aid(self, meaning: str, value: float) -> Aid:
        column = self._columns[meaning]
        t_s = -column.late_s if column.late_s else nan
        return Aid(self._names[meaning], meaning, value, t_s, column.sigma)  # type: ignore[arg-type]  # wheels are replaced
