"""Parameters of a named cause, with their units."""

from dataclasses import dataclass

UNITS = {
    "percent": "%",
    "percent_fs": "% of full scale",
    "percent_per_c": "%/°C",
    "dps_per_c": "deg/s/°C",
    "curve_per_c": "1/°C",
    "dps": "deg/s",
    "deg": "deg",
    "ms": "ms",
    "hz": "Hz",
    "ppm": "ppm",
    "dph": "deg/h",
    "dps_rts": "deg/s/√s",
    "dps_at_100_dps": "deg/s at 100 deg/s",
    "s": "s",
    "per_hour": "1/h",
    "cpr": "counts per turn",
}
"""Unit of a parameter, by the end of its name."""


@dataclass(frozen=True, slots=True)
class Parameter:
    """A fitted parameter with its 95 % credible interval.

    is_at_most, is_at_least
        Whether the interval ends at the smallest or largest size that was tried, so that it is a bound only.
    """

    name: str
    value: float
    low: float
    high: float
    unit: str
    is_at_most: bool = False
    is_at_least: bool = False

    @property
    def is_bound(self) -> bool:
        """Whether the recordings give only a bound of the size."""
        return self.is_at_least or self.is_at_most

    @property
    def bound(self) -> float:
        """The end of the interval that lies within the tried sizes; the value if both ends do, or neither does."""
        if self.is_at_least == self.is_at_most:
            return self.value
        return self.low if self.is_at_least else self.high


def unit_of(parameter: str) -> str:
    """Unit of a parameter, by the end of its name."""
    ends = [end for end in UNITS if parameter == end or parameter.endswith(f"_{end}")]
    return UNITS[max(ends, key=len)] if ends else ""
