"""Check of what a stream says it is, in its first minutes: the clock, the rate and its unit, the axis that turns.

The form of text lines without labels is a guess until the device has turned. If the numbers contradict it, the link
ends with a question, unless the user stated the form or the unit, or only records: then an event tells it.
"""

import shlex
from collections.abc import Callable
from math import isnan
from typing import Any

from gyrodrift.columns.sizes import WINDOW
from gyrodrift.link.clocks.clock import Clock
from gyrodrift.link.heard import Heard, quoted
from gyrodrift.link.protocols import text
from gyrodrift.link.protocols.protocol import WireProtocol
from gyrodrift.values.errors import UnitError
from gyrodrift.values.sample import Sample

CLOCK_S = 1.5
"""Time of samples before the clock is judged, s."""

CLOCK_READINGS = 10
RATE_EVERY_S = 1.0
RATE_WINDOWS = 300
"""Number of windows after which the check ends: five minutes."""

EAGER_WINDOWS = 20
PATIENT_WINDOWS = 10
"""The first EAGER_WINDOWS are all evaluated, later every tenth window: evaluation costs more than collecting."""


class UnitCheck:
    """Check that takes all readings until it `is_over`, and reports contradictions as events.

    `port` is the name of the port for advice; with `keeps_on`, only a wrong clock is an error.

    Raises
    ------
    UnitError
        From `take`: the clock does not count microseconds, or the rate is none in deg/s, and the user did not state it.
    """

    def __init__(
        self,
        protocol: WireProtocol,
        heard: Heard,
        on_event: Callable[..., Any],
        port: str,
        *,
        has_clock: bool,
        keeps_on: bool = False,
    ) -> None:
        self.is_over = protocol.sends_angle and not has_clock
        self.is_hearing = has_clock
        self._protocol = protocol.name
        self._port = shlex.quote(port)
        self._keeps_on = keeps_on
        self._is_stated = protocol.is_asked and protocol.is_unit_said
        self._scale = protocol.rate_scale
        self._has_rate = not protocol.sends_angle
        self._shape: Any = None
        self._is_shape_over = protocol.name not in SHAPED or protocol.sends_angle
        self._heard = heard
        self._on_event = on_event
        self._readings = 0
        self._first_s = 0.0
        self._window: list[Sample] = []
        self._due_s = float("-inf")
        self._rates: Any = None
        self._windows = 0
        self._measures_pace = has_clock and protocol.name == "csv"
        self._pace_from: tuple[float, float] | None = None
        self._paced_s = 0.0
        self._counted = 0.0
        self._acceleration_checks: dict[str, Any] = {}

    def take(self, readings: int, samples: list[Sample], arrival_s: float, clock: Clock) -> None:
        """Add a number of readings that arrived together, and their samples."""
        if self.is_hearing:
            self._first_s = self._first_s or arrival_s
            self._readings += readings
            if arrival_s - self._first_s >= CLOCK_S and self._readings >= CLOCK_READINGS:
                self.is_hearing = False
                self._judge_clock(clock)
        if samples and self._measures_pace:
            self._judge_pace(samples[-1], arrival_s)
        if not self._has_rate:
            self.is_over = not self.is_hearing
            return
        if samples and samples[-1].inertial is not None:
            self._judge_accelerations(samples)
        if samples and not self._is_shape_over:
            self._judge_shape(samples)
        self._window += samples
        if len(self._window) >= WINDOW:
            self._judge_windows()

    def _judge_clock(self, clock: Clock) -> None:
        why = why_wrong(clock.pace if clock.period_s else float("inf"), self._protocol, self._heard)
        self._heard = Heard()
        if why is not None:
            raise UnitError(why)

    def _judge_pace(self, sample: Sample, arrival_s: float) -> None:
        """Compare the clock of text with the arrival of its lines, twice; a burst or a busy computer is no pace."""
        pause_s, self._paced_s = arrival_s - self._paced_s, arrival_s
        if not self._pace_from or pause_s > PACE_PAUSE_S:
            self._pace_from, self._counted = (arrival_s, sample.t_device_s), 0.0
        if arrival_s - self._pace_from[0] < PACE_S:
            return
        counted_s, took_s = sample.t_device_s - self._pace_from[1], arrival_s - self._pace_from[0]
        self._pace_from = arrival_s, sample.t_device_s
        before, self._counted = self._counted, counted_s / took_s
        is_wrong = 1.0 / SLOWEST_PACE < self._counted < 1.0 / LEAST_PACE or LEAST_PACE < self._counted < FASTEST_REPLAY
        if not is_wrong or abs(self._counted - before) > SAME_PACE * self._counted:
            return
        self._measures_pace = False
        ticks = float(f"{1e6 * self._counted:.2g}")
        reason = f"the clock counts {self._counted:.3g} s in each second of the lines' arrival"
        spec = _csv_spec(sample).replace("t_us", f"t:lsb/{ticks:.0f}", 1).format("dps")
        hint = f"if its ticks are not µs, read it with --columns '{spec}', N ticks a second"
        if self._counted > 1.0:
            self._on_event("rate_doubted", protocol=self._protocol, reason=f"{reason}, as a replay may", hint=hint)
        else:
            self._withdraw(reason, f"{hint}; if it is a slow replay, state --protocol csv")

    def _judge_accelerations(self, samples: list[Sample]) -> None:
        from gyrodrift.columns.accel_axes import (  # noqa: PLC0415 - only for three axes
            AccelerationAxesCheck,
            TurningAxisCheck,
        )
        from gyrodrift.columns.gravity_check import AccelerationCheck  # noqa: PLC0415 - as above

        self._acceleration_checks = self._acceleration_checks or {
            "accel_unit_differs": AccelerationCheck(self._protocol),
            "accel_axes_differ": AccelerationAxesCheck(self._protocol),
            "axis_differs": TurningAxisCheck(),
        }
        for event, check in self._acceleration_checks.items():
            fields = None if check.is_over else check.take(samples)
            if fields is not None:
                self._on_event(event, **fields)

    def _judge_shape(self, samples: list[Sample]) -> None:
        from gyrodrift.columns.shape import RateShape  # noqa: PLC0415 - after the first sample is out

        shape = self._shape = self._shape or RateShape()
        is_doubted = bool(shape.doubt)
        shape.take(samples)
        self._is_shape_over = shape.is_over or bool(shape.contradiction)
        is_csv = self._protocol == "csv"
        hint = "name the columns with --columns, or find them by a quarter turn: " + self._turn
        if shape.contradiction and (shape.is_impossible or is_csv):
            yaw = f"if it is the yaw, read it with --columns '{shape.spec}'; else " if shape.spec else ""
            self._withdraw(shape.contradiction, f"{yaw}{hint}", is_sure=shape.is_impossible)
        elif shape.doubt and not is_doubted and is_csv and not self._is_stated:
            self._on_event("rate_doubted", reason=shape.doubt, hint=f"unless the device turns all the time, {hint}")

    @property
    def _turn(self) -> str:
        return f"gyrodrift doctor --port {self._port} --turn"

    def _withdraw(self, reason: str, hint: str, *, is_sure: bool = False) -> None:
        """Tell that the numbers are no rate in deg/s; end, if nobody stated it, or if no rate can be so."""
        ends = (is_sure or not self._is_stated) and not self._keeps_on
        event = "verdict_withdrawn" if ends else "rate_doubted"
        self._on_event(event, protocol=self._protocol, reason=reason, hint=hint)
        if ends:
            why = "the unit of its rates is not stated: " if self._protocol == text.NAME and not is_sure else ""
            raise UnitError(f"{why}{reason}; {hint}; yaw so far is wrong")

    def _judge_windows(self) -> None:
        whole = len(self._window) // WINDOW * WINDOW
        for start in range(0, whole, WINDOW):
            if self._window[start + WINDOW - 1].t_device_s >= self._due_s and not self.is_over:
                self._judge_rates(self._window[start : start + WINDOW])
        del self._window[:whole]

    def _judge_rates(self, window: list[Sample]) -> None:
        from gyrodrift.columns.rate_unit import (  # noqa: PLC0415 - after the first sample is out
            RateUnitOdds,
            event_fields,
        )

        self._rates = self._rates or RateUnitOdds(self._scale)
        self._rates.take(window)
        self._windows += 1
        self._due_s = window[-1].t_device_s + RATE_EVERY_S
        if self._windows > EAGER_WINDOWS and self._windows % PATIENT_WINDOWS:
            return
        likely = self._rates.sure()
        if likely:
            period_s = (window[-1].t_device_s - window[0].t_device_s) / (len(window) - 1)
            fields = event_fields(likely, self._protocol, _csv_spec(window[-1]), self._port, period_s)
            if self._is_stated or self._keeps_on or self._protocol not in SHAPED:
                self._on_event("rate_unit_differs", **fields)
            else:
                self._withdraw(str(fields["reason"]), str(fields["hint"]))
        self.is_over = bool(likely) or (self._windows >= RATE_WINDOWS and self._is_shape_over)


SHAPED = frozenset({"csv", text.NAME})
"""Protocols of text, whose columns a person or a guess names."""


def _csv_spec(sample: Sample) -> str:
    """SPEC of csv lines like this sample, with `{}` for the unit of the rates."""
    if sample.inertial is not None:
        return "t_us, gx:{0}, gy:{0}, gz:{0}, ax, ay, az"
    columns = ["t_us", "rate:{0}"]
    if not isnan(sample.encoder_deg):
        columns.append("encoder")
    return ", ".join(columns)


PACE_S, LEAST_PACE, SAME_PACE = 3.0, 1.6, 0.05
"""Time over which a pace is measured, s, least factor by which it is wrong, and largest difference of two of them."""

PACE_PAUSE_S = 0.5
"""A pause of the lines after which a pace is measured again, s: what the clock did meanwhile is unknown."""

FASTEST_REPLAY = 10.0
"""A clock that is faster than this is that of a replay as fast as it can."""

SLOWEST_PACE = 100.0
"""Host seconds per second of a device clock: no real clock is that slow, and a replay is faster."""

NEVER_PACE = 1e7
NAMED_WITHIN = 3.0
UNITS = {1e3: "milliseconds", 1e6: "seconds"}
CSV_COLUMNS = ("t_us", "rate:dps", "encoder", "temp", "still")
SHORT = {"milliseconds": "t_ms", "seconds": "t_s"}


def why_wrong(pace: float, protocol: str, heard: Heard) -> str | None:
    """Message about a clock in another unit; None if it may be correct.

    `pace` is host seconds per second of the device clock, infinite if it does not run.
    """
    if pace < SLOWEST_PACE:
        return None
    unit = next((unit for per, unit in UNITS.items() if per / NAMED_WITHIN < pace < per * NAMED_WITHIN), None)
    took = f"1 s of it takes {pace:.3g} s" if pace < NEVER_PACE else "its steps are not those of a clock"
    says = f"counts {unit}, not microseconds" if unit else f"does not count microseconds: {took}"
    if protocol == "csv":
        return f"the first column {says}; {_columns(heard, unit)}"
    if protocol == text.NAME:
        named = f": write {SHORT[unit]} instead of t_us" if unit else ""
        return f"the clock of --columns {says}{named}; the lines are like {quoted((heard.lines() or [''])[-1])}"
    return f"the clock t_us of its samples {says}; the device must send microseconds"


def _columns(heard: Heard, unit: str | None) -> str:
    """Advice for csv lines with another clock."""
    last = (heard.lines() or [""])[-1]
    if unit is None:
        return f"name the columns of {quoted(last)} with --columns"
    columns = (SHORT[unit], *CSV_COLUMNS[1:])[: last.count(",") + 1]
    return f"read {quoted(last)} with --columns {shlex.quote(', '.join(columns))}"
