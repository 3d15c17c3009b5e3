"""Measurements of second sources for the filters of the library."""

from math import isfinite, nan
from typing import Any

from gyrodrift.filters.hdr_filter import HDR
from gyrodrift.filters.run import FilterRun
from gyrodrift.values.aid import Aid, AidKind, AidStatus
from gyrodrift.values.constants import FULL_TURN_DEG
from gyrodrift.values.errors import UsageError

NEED_UNCERTAINTY = ("heading", "turn_rate", "wheels")
"""Kinds that a filter weighs against its own uncertainty, which hdr has not."""


class SecondSources:
    """Base of the filters: what a second source measures, besides the gyro.

    A measurement is evidence: it may be late, wrong now and then, or stop. Measurements of one `name` share their
    unknown offset, scale and trust; give two sources of one kind two names. `t_s` is the time of the measurement on
    the clock of the samples, s, and may lie in the past; None is that of the last sample.
    """

    _run: FilterRun

    def heading(
        self,
        deg: float,
        sigma_deg: float,
        t_s: float | None = None,
        modulo_deg: float = FULL_TURN_DEG,
        *,
        name: str = "heading",
    ) -> None:
        """Take a heading, counter-clockwise positive; its zero may be another than that of yaw.

        Parameters
        ----------
        deg, sigma_deg
            Heading and its standard deviation, deg. A compass counts clockwise: give it with the other sign.
        t_s
            Time of the measurement, s; None for now.
        modulo_deg
            360, or 90 for one of the four directions of a building, or 45.
        name
            Name of the source.

        Raises
        ------
        UsageError
            A number is wrong, or the filter gives no uncertainty, as hdr.
        """
        if not 0.0 < modulo_deg <= FULL_TURN_DEG or FULL_TURN_DEG % modulo_deg:
            raise UsageError(f"heading: modulo_deg is {modulo_deg!r}; expected 360, or a part of it such as 90 or 45")
        self._take("heading", name, deg, sigma_deg, t_s, period_deg=float(modulo_deg))

    def turn_rate(self, dps: float, sigma_dps: float, t_s: float | None = None, *, name: str = "turn_rate") -> None:
        """Take a rate about the vertical and its standard deviation, deg/s, counter-clockwise positive.

        Raises
        ------
        UsageError
            As for `heading`.
        """
        self._take("turn_rate", name, dps, sigma_dps, t_s)

    def wheels(
        self,
        left_speed: float,
        right_speed: float,
        sigma: float | None = None,
        t_s: float | None = None,
        *,
        name: str = "wheels",
    ) -> None:
        """Take the speeds of a left and a right wheel, forward positive, in any unit; the track may be unknown.

        Raises
        ------
        UsageError
            As for `heading`.
        """
        self._take("wheels", name, right_speed - left_speed, sigma, t_s, speed=0.5 * (left_speed + right_speed))

    def speed(
        self, mps: float, sigma_mps: float | None = None, t_s: float | None = None, *, name: str = "speed"
    ) -> None:
        """Take the speed of the device and its standard deviation, m/s; a speed of 0 speaks for a rest.

        Raises
        ------
        UsageError
            A number is wrong.
        """
        self._take("speed", name, mps, sigma_mps, t_s)

    def standing(
        self,
        is_standing: bool,  # noqa: FBT001 - the one value of the measurement
        t_s: float | None = None,
        *,
        name: str = "standing",
    ) -> None:
        """Take the word of a brake, a motor or a person: the device stands, or it moves.

        Raises
        ------
        UsageError
            The time is wrong.
        """
        self._take("standing", name, float(bool(is_standing)), None, t_s)

    @property
    def aids(self) -> dict[str, AidStatus]:
        """How each second source agrees with the filter, by its name: `age_s`, `weight` and `differs`."""
        return self._run.aids

    def _take(
        self, kind: AidKind, name: str, value: float, sigma: float | None, t_s: float | None, **further: Any
    ) -> None:
        if self._run.filter is HDR and kind in NEED_UNCERTAINTY:
            raise UsageError(f"{kind}: hdr gives no uncertainty to weigh it against; use Restlevel")
        numbers = [float(number) for number in (value, sigma, t_s) if number is not None]
        if not all(map(isfinite, numbers)) or (sigma is not None and sigma <= 0.0):
            raise UsageError(f"{kind}: expected finite numbers and a sigma above 0, not {value!r}, {sigma!r}, {t_s!r}")
        time_s, deviation = (nan if number is None else float(number) for number in (t_s, sigma))
        self._run.aid(Aid(name, kind, float(value), time_s, deviation, **further))
