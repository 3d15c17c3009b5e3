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

    prefix
        Words before each name: the source of the lines, with a point.
    """

    def __init__(self, columns: Sequence[Column], prefix: str = "") -> None:
        self._columns = {column.meaning: column for column in columns if column.meaning in AID_MEANINGS}
        self._prefix = prefix
        self._last_deg = nan

    def __bool__(self) -> bool:
        return bool(self._columns)

    @property
    def names(self) -> dict[str, str]:
        """Name of the source by the meaning of a column."""
        names = {meaning: column.label or meaning for meaning, column in self._columns.items()}
        return {name: self._prefix + (WHEELS_NAME if name in WHEELS else label) for name, label in names.items()}

    def aids_of(self, values: Mapping[str, float]) -> tuple[Aid, ...]:
        """Measurements of a line, whose times count from it; values by meaning, in their units, NaN if missing."""
        known = {name: value for name in self._columns if isfinite(value := values.get(name, nan))}
        speed = known.get("speed", nan)
        aids = [self._aid(name, known[name]) for name in ("speed", "turn_rate") if name in known]
        heading_deg = values.get("heading", nan) if "heading" in self._columns else nan
        if isfinite(heading_deg) and heading_deg != self._last_deg:
            column = self._columns["heading"]
            aids.append(self._aid("heading", heading_deg)._replace(period_deg=column.modulo_deg, speed=speed))
        self._last_deg = heading_deg
        if all(name in known for name in WHEELS):
            left, right = (known[name] for name in WHEELS)
            aids.append(self._aid(WHEELS[0], right - left)._replace(kind="wheels", speed=0.5 * (left + right)))
        return tuple(aids)

    def _aid(self, meaning: str, value: float) -> Aid:
        column = self._columns[meaning]
        t_s = -column.late_s if column.late_s else nan
        return Aid(self.names[meaning], meaning, value, t_s, column.sigma)  # type: ignore[arg-type]  # wheels are replaced
