"""Steps of a calibration: rest, temperature run if requested, then turn after turn, with instructions for the user.

The guide takes samples and keys, and never waits. With a user, a key marks every stop; without, the guide recognizes a
stop by the rest of the device. A failed step is repeated with a user, and raises an error without.
"""

from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from datetime import datetime
from enum import Enum
from math import isfinite, isnan
from typing import Any

from gyrodrift.calibrate.move import FinishedMove, Move
from gyrodrift.calibrate.rest import RestMeasurement, rest_of
from gyrodrift.calibrate.scale import REPEATS_MIN, Scales, Turns, check_turns, checked_scales, scales_of
from gyrodrift.calibrate.warming import BiasLine, Warming
from gyrodrift.values.calibration import Calibration
from gyrodrift.values.errors import CalibrationError
from gyrodrift.values.sample import Sample

HANDS_OFF_S = 0.5
"""A key press shakes the table for about this time, s."""

MOVED_DEG = 90.0
"""Angle from which a motion counts as a turn, and largest distance of a stop from whole turns, without a user."""

NO_TURN_S = 120.0
"""Without a user, a rest of this length ends the calibration, s."""

HALF_WAY_S = 10.0
"""Without a user, a stop of this length counts as the mark, whatever the angle, s."""

PIECE = 10
"""Samples per step, so that a stop is recognized at its time, however many samples were read at once."""


class Key(Enum):
    """Input of the user."""

    ENTER = ""
    UNDO = "u"
    ENOUGH = "q"


class GuideStep(Enum):
    """Step of the calibration."""

    READY = "ready"
    REST = "rest"
    WARMING = "warming"
    AT_MARK = "at the mark"
    TURNING = "turning"
    DONE = "done"


@dataclass(frozen=True, slots=True)
class CalibrationPlan:
    """Requested calibration.

    turns, repeats_max
        Whole turns at a time, and largest number of repeats per direction.
    spread
        Standard error of the scale at which the turns are enough, as a fraction.
    rest_s, warming_s
        Lengths of the rest and of the temperature run, s; 0 for no temperature run.
    is_by_hand
        Whether a user presses keys.
    """

    turns: int = 1
    repeats_max: int = 10
    spread: float = 0.001
    rest_s: float = 10.0
    warming_s: float = 0.0
    is_by_hand: bool = True


@dataclass(slots=True)
class Guide:
    """State of a calibration; `say` gets every instruction and result as a sentence."""

    plan: CalibrationPlan
    say: Callable[[str], object]
    step: GuideStep = GuideStep.READY
    turns: list[Turns] = field(default_factory=list)
    line_of_bias: BiasLine | None = None
    _rest: RestMeasurement | None = None
    _samples: list[Sample] = field(default_factory=list)
    _warming: Warming | None = None
    _move: Move | None = None
    _is_asked: bool = False

    def begin(self) -> None:
        """Start, with the first instruction."""
        if self.plan.is_by_hand:
            self.say("Put the device on a firm table, with its mark at a mark on the table. Press Enter to start.")
        else:
            self._begin_rest()

    def take(self, samples: list[Sample], clipped: int = 0) -> None:
        """Add samples; `clipped` of them were marked as out of range by the device.

        Raises
        ------
        CalibrationError
            A step failed, and there is no user to repeat it.
        """
        for start in range(0, len(samples), PIECE):
            self._take_piece(samples[start : start + PIECE], clipped if start == 0 else 0)

    def _take_piece(self, samples: list[Sample], clipped: int) -> None:
        match self.step:
            case GuideStep.REST:
                self._take_rest(samples)
            case GuideStep.WARMING if self._warming is not None:
                self._take_warming(self._warming, samples)
            case GuideStep.AT_MARK | GuideStep.TURNING if self._move is not None:
                self._move.take(samples, clipped)
                self._look(self._move)

    def press(self, key: Key) -> None:
        """Handle an input line of the user."""
        match key, self.step:
            case Key.ENTER, GuideStep.READY:
                self._begin_rest()
            case Key.ENTER, GuideStep.AT_MARK | GuideStep.TURNING if self._move is not None:
                self._is_asked = True
                self._look(self._move)
            case Key.ENOUGH, GuideStep.WARMING if self._warming is not None:
                self._end_warming(self._warming)
            case Key.ENOUGH, _:
                self.step = GuideStep.DONE
            case Key.UNDO, _ if self.turns:
                removed = self.turns.pop()
                self.say(f"Removed the last turn: {removed.angle_deg:+.1f} deg.")
                self._to_the_mark(f"Go back to the mark for {self._next_words}.")

    @property
    def line(self) -> str:
        """Current state, for the status line."""
        match self.step:
            case GuideStep.REST:
                passed_s = self._samples[-1].t_device_s - self._samples[0].t_device_s if self._samples else 0.0
                return f"at rest: {passed_s:.0f} of {self.plan.rest_s:g} s, do not touch it"
            case GuideStep.WARMING if self._warming is not None:
                passed = f"{self._warming.seconds / 60.0:.1f} of {self.plan.warming_s / 60.0:g} min"
                return f"warming at rest: {passed}, {self._warming.temp_c:.1f} °C, {self._warming.last_dps:+.4f} deg/s"
            case GuideStep.AT_MARK | GuideStep.TURNING if self._move is not None:
                is_still = "at rest" if self._move.is_stopped else "moving"
                if self.step is GuideStep.AT_MARK:
                    return f"on the way to the mark: {is_still}"
                return f"{self._next_words}: reads {self._move.angle_deg:+.1f} deg, {is_still}"
        return ""

    def result(self, now: datetime, device_id: str, dps_per_lsb: float | None) -> Calibration:
        """Calibration from all steps; `dps_per_lsb` as the device states it, or None.

        Raises
        ------
        CalibrationError
            There are too few turns, or they differ too much.
        """
        if self._rest is None:
            raise CalibrationError("there was no rest yet, so there is no calibration")
        scales, rest, run = checked_scales(self.turns), self._rest, self.line_of_bias
        return Calibration(
            date=now.isoformat(timespec="seconds"),
            device_id=device_id,
            bias_dps=rest.bias_dps if run is None else run.bias_dps,
            bias_se_dps=rest.bias_se_dps,
            temp_c=(rest.temp_c if isfinite(rest.temp_c) else None) if run is None else run.temp_c,
            bias_dps_per_c=0.0 if run is None else run.slope_dps_per_c,
            bias_dps_per_c_se=None if run is None else run.slope_se_dps_per_c,
            temp_low_c=None if run is None else run.low_c,
            temp_high_c=None if run is None else run.high_c,
            noise_dps_rthz=rest.noise_dps_rthz,
            dps_per_lsb=dps_per_lsb or rest.dps_per_lsb,
            **asdict(scales),
        )

    def measured(self) -> dict[str, Any]:
        """Measurements for JSON."""
        return {"turns": [move._asdict() for move in self.turns]}

    @staticmethod
    def merged(new: Calibration, old: Calibration | None) -> Calibration:
        """A result, with the values of a replaced calibration that were not measured."""
        return new.keeping_axes(old)

    def _begin_rest(self) -> None:
        self.step = GuideStep.REST
        self._samples.clear()
        self.say(f"Rest: {self.plan.rest_s:g} s. Do not touch it.")

    def _take_rest(self, samples: list[Sample]) -> None:
        self._samples += samples
        begun_s = self._samples[0].t_device_s + (HANDS_OFF_S if self.plan.is_by_hand else 0.0)
        if self._samples[-1].t_device_s - begun_s < self.plan.rest_s:
            return
        try:
            self._rest = rest_of([sample for sample in self._samples if sample.t_device_s >= begun_s])
        except CalibrationError as error:
            self._refuse(error)
            self.step = GuideStep.READY
            self.say("Press Enter to repeat the rest.")
            return
        rest = self._rest
        self.say(
            f"  bias {rest.bias_dps:+.4f} ± {rest.bias_se_dps:.4f} deg/s, noise {rest.noise_dps_rthz:.2g} deg/s/√Hz"
            + (f", {rest.temp_c:.1f} °C" if isfinite(rest.temp_c) else "")
        )
        if self.plan.warming_s:
            self._begin_warming(rest)
        else:
            self._begin_turns(rest, rest.bias_dps)

    def _begin_warming(self, rest: RestMeasurement) -> None:
        if isnan(rest.temp_c):
            self._refuse(CalibrationError("the device sends no temperature, so a temperature run is impossible"))
            self._begin_turns(rest, rest.bias_dps)
            return
        self.step, self._warming = GuideStep.WARMING, Warming(rest, rest.bias_dps)
        early = "; q ends it" if self.plan.is_by_hand else ""
        self.say(f"Temperature run: {self.plan.warming_s / 60.0:g} min. Do not touch it while it warms up{early}.")

    def _take_warming(self, warming: Warming, samples: list[Sample]) -> None:
        warming.take(samples)
        if warming.seconds >= self.plan.warming_s:
            self._end_warming(warming)

    def _end_warming(self, warming: Warming) -> None:
        try:
            run = self.line_of_bias = warming.line()
        except CalibrationError as error:
            self._refuse(CalibrationError(f"temperature run: {error}"))
        else:
            self.say(
                f"  bias {run.bias_dps:+.4f} deg/s at {run.temp_c:.1f} °C, {run.slope_dps_per_c:+.5f} ± "
                f"{run.slope_se_dps_per_c:.5f} deg/s per °C, from {run.low_c:.1f} to {run.high_c:.1f} °C"
            )
        self._begin_turns(warming.rest, warming.last_dps)

    def _begin_turns(self, rest: RestMeasurement, bias_dps: float) -> None:
        if self.plan.is_by_hand:
            self.say("Turns: as slowly as you like. u removes the last turn, q ends the calibration.")
        self._begin_move(rest, bias_dps)

    def _begin_move(self, rest: RestMeasurement, bias_dps: float, so_far: list[Sample] | None = None) -> None:
        self._move, self._is_asked, self.step = Move(rest, bias_dps), False, GuideStep.TURNING
        self._move.take(so_far or [])
        enter = ", stop at the mark, then press Enter" if self.plan.is_by_hand else ", stop at the mark"
        self.say(f"Turn {self._next_words}{enter}.")

    def _to_the_mark(self, words: str) -> None:
        """Ask the user to move the device to the mark."""
        if self._rest is None or self._move is None:
            return
        self._move, self._is_asked, self.step = Move(self._rest, self._move.bias_dps), False, GuideStep.AT_MARK
        self.say(f"{words} Press Enter when it stands there.")

    def _look(self, move: Move) -> None:
        """End the move if it is over."""
        if not move.is_stopped or not self._is_over(move):
            return
        self._is_asked = False
        if self.step is GuideStep.AT_MARK:
            self._begin_move(move.rest, *move.last_rest())
            return
        try:
            done = move.finished()
            new = Turns(self._is_next_ccw, self.plan.turns, done.angle_deg)
            check_turns(new, self.turns)
        except CalibrationError as error:
            self._refuse(error)
            self._to_the_mark("Go back to the mark.")
            return
        self._keep(new, done, move.rest)

    def _is_over(self, move: Move) -> bool:
        if self.plan.is_by_hand:
            return self._is_asked
        whole_deg = 360.0 * self.plan.turns
        if abs(move.angle_deg) < MOVED_DEG:
            if move.seconds > NO_TURN_S:
                raise CalibrationError(f"no turn within {NO_TURN_S:g} s")
            return False
        return abs(abs(move.angle_deg) - whole_deg) < MOVED_DEG or move.still_s > HALF_WAY_S

    def _keep(self, new: Turns, done: FinishedMove, rest: RestMeasurement) -> None:
        self.turns.append(new)
        whole_deg = 360.0 * new.turns
        error = f"{100.0 * (abs(new.angle_deg) / whole_deg - 1.0):+.2f} %"
        self.say(f"  {new.angle_deg:+.2f} deg for {whole_deg:.0f}, {error}; up to {done.fastest_dps:.0f} deg/s")
        scales = scales_of(self.turns)
        is_pair = not new.is_ccw
        if scales is not None and is_pair:
            self.say(f"  {scales_text(scales)}")
            if scales.spread <= self.plan.spread or scales.repeats >= self.plan.repeats_max:
                self.step = GuideStep.DONE
                return
        self._begin_move(rest, done.bias_dps, done.rest)

    def _refuse(self, error: CalibrationError) -> None:
        """Tell the user to repeat the step; without a user, raise the error."""
        if not self.plan.is_by_hand:
            raise error
        self.say(f"Not accepted: {str(error).rstrip('.')}{'' if str(error).endswith('?') else '.'}")

    @property
    def _is_next_ccw(self) -> bool:
        return len(self.turns) % 2 == 0

    @property
    def _next_words(self) -> str:
        count = "one whole turn" if self.plan.turns == 1 else f"{self.plan.turns} whole turns"
        way = "counter-clockwise, seen from above" if self._is_next_ccw else "clockwise, back again"
        return f"{count} {way} ({len(self.turns) // 2 + 1} of {REPEATS_MIN} to {self.plan.repeats_max})"


def scales_text(scales: Scales) -> str:
    """Scales of both directions with standard errors, and the standard deviation of a stop at the mark."""
    return (
        f"scale counter-clockwise {scales.scale_ccw:.5f} ± {scales.scale_ccw_se:.5f}, clockwise "
        f"{scales.scale_cw:.5f} ± {scales.scale_cw_se:.5f}; stops at the mark ± {scales.mark_deg:.2f} deg"
    )
