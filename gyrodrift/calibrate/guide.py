"""What is done in which order, and what the person is told: rest, warming where it is wished, turn after turn.

The guide is handed samples and keys and never waits. By hand each stop at the mark is told by a key; without hands by
the device standing still. What goes wrong is told and done again by hand, and is an error without.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from datetime import datetime
from enum import Enum
from math import isfinite, isnan

from gyrodrift.calibrate.move import FinishedMove, Move
from gyrodrift.calibrate.rest import RestMeasurement, rest_of
from gyrodrift.calibrate.scale import LEAST, Scales, Turns, check_turns, scales_of, settled
from gyrodrift.calibrate.warming import BiasLine, Warming
from gyrodrift.calibration import Calibration
from gyrodrift.errors import CalibrationError
from gyrodrift.sample import Sample

HANDS_OFF_S = 0.5
"""The stroke of a key shakes the table."""

MOVED_DEG = 90.0
NO_TURN_S = 120.0
"""Without hands, a device that stands for so long is not turned any more."""

HALF_WAY_S = 10.0
"""Without hands, a stop of this length is one at the mark, wherever it is."""


PIECE = 10
"""Samples that are looked at together, however many were read at once: a stop is seen where it is."""


class Key(Enum):
    """What a person says."""

    ENTER = ""
    UNDO = "u"
    ENOUGH = "q"


class GuideStep(Enum):
    """Where the guide is."""

    READY = "ready"
    REST = "rest"
    WARMING = "warming"
    AT_MARK = "at the mark"
    TURNING = "turning"
    DONE = "done"


@dataclass(frozen=True, slots=True)
class CalibrationPlan:
    """What is asked for.

    turns, most
        Whole turns at a time, and how often each direction is turned at most.
    spread
        Standard error of the scale at which there are turns enough, as a share.
    rest_s, warming_s
        Lengths of the rest and of the temperature run, s; 0 for none.
    is_by_hand
        Whether a person presses keys.
    """

    turns: int = 1
    most: int = 10
    spread: float = 0.001
    rest_s: float = 10.0
    warming_s: float = 0.0
    is_by_hand: bool = True


@dataclass(slots=True)
class Guide:
    """A calibration under way; `say` is called with each sentence that stays on the screen."""

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
        """Say what comes first."""
        if self.plan.is_by_hand:
            self.say("Put the device on a firm table, its mark at a mark of the table. Enter begins with the rest.")
        else:
            self._begin_rest()

    def take(self, samples: list[Sample], clipped: int = 0) -> None:
        """Samples of the device, and how many of them it marked as out of its range.

        Raises
        ------
        CalibrationError
            Where something went wrong that nobody can do again.
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
        """A key, with Enter behind it."""
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
                taken = self.turns.pop()
                self.say(f"Taken back: {taken.angle_deg:+.1f} deg.")
                self._to_the_mark(f"Back to the mark for {self._next_words}.")

    @property
    def line(self) -> str:
        """What is going on, for one line that is rewritten."""
        match self.step:
            case GuideStep.REST:
                had_s = self._samples[-1].t_device_s - self._samples[0].t_device_s if self._samples else 0.0
                return f"at rest: {had_s:.0f} of {self.plan.rest_s:g} s, hands off"
            case GuideStep.WARMING if self._warming is not None:
                had = f"{self._warming.seconds / 60.0:.1f} of {self.plan.warming_s / 60.0:g} min"
                return f"warming at rest: {had}, {self._warming.temp_c:.1f} °C, {self._warming.last_dps:+.4f} deg/s"
            case GuideStep.AT_MARK | GuideStep.TURNING if self._move is not None:
                is_still = "at rest" if self._move.is_stopped else "moving"
                if self.step is GuideStep.AT_MARK:
                    return f"on the way to the mark: {is_still}"
                return f"{self._next_words}: reads {self._move.angle_deg:+.1f} deg, {is_still}"
        return ""

    def result(self, now: datetime, device_id: str, dps_per_lsb: float | None) -> Calibration:
        """All of it together; `dps_per_lsb` as the device states it, None where it does not.

        Raises
        ------
        CalibrationError
            Where there is too little, or what there is differs too much.
        """
        if self._rest is None:
            raise CalibrationError("there was no rest yet; nothing is known")
        scales, rest, run = settled(self.turns), self._rest, self.line_of_bias
        return Calibration(
            date=now.isoformat(timespec="seconds"),
            device_id=device_id,
            sign=scales.sign,
            scale_ccw=scales.scale_ccw,
            scale_ccw_se=scales.scale_ccw_se,
            scale_cw=scales.scale_cw,
            scale_cw_se=scales.scale_cw_se,
            bias_dps=rest.bias_dps if run is None else run.bias_dps,
            bias_se_dps=rest.bias_se_dps,
            temp_c=(rest.temp_c if isfinite(rest.temp_c) else None) if run is None else run.temp_c,
            bias_dps_per_c=0.0 if run is None else run.slope_dps_per_c,
            bias_dps_per_c_se=None if run is None else run.slope_se_dps_per_c,
            temp_low_c=None if run is None else run.low_c,
            temp_high_c=None if run is None else run.high_c,
            noise_dps_rthz=rest.noise_dps_rthz,
            dps_per_lsb=dps_per_lsb or rest.dps_per_lsb,
            turns=scales.turns,
            repeats=scales.repeats,
            mark_deg=scales.mark_deg,
        )

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
            self.say("Enter begins the rest again.")
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
            self._refuse(CalibrationError("the device sends no temperature, so there is no temperature run"))
            self._begin_turns(rest, rest.bias_dps)
            return
        self.step, self._warming = GuideStep.WARMING, Warming(rest, rest.bias_dps)
        early = "; q ends it earlier" if self.plan.is_by_hand else ""
        self.say(f"Temperature run: {self.plan.warming_s / 60.0:g} min. Do not touch it while it warms{early}.")

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
            self.say("Turns: as slowly as you like. u takes the last one back, q ends with what is there.")
        self._begin_move(rest, bias_dps)

    def _begin_move(self, rest: RestMeasurement, bias_dps: float, so_far: list[Sample] | None = None) -> None:
        self._move, self._is_asked, self.step = Move(rest, bias_dps), False, GuideStep.TURNING
        self._move.take(so_far or [])
        enter = ", stop at the mark, then Enter" if self.plan.is_by_hand else ", stop at the mark"
        self.say(f"Turn {self._next_words}{enter}.")

    def _to_the_mark(self, words: str) -> None:
        """From wherever it is; by hand."""
        if self._rest is None or self._move is None:
            return
        self._move, self._is_asked, self.step = Move(self._rest, self._move.bias_dps), False, GuideStep.AT_MARK
        self.say(f"{words} Enter when it stands there.")

    def _look(self, move: Move) -> None:
        """Whether a move is over."""
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
            self._to_the_mark("Back to the mark.")
            return
        self._keep(new, done, move.rest)

    def _is_over(self, move: Move) -> bool:
        if self.plan.is_by_hand:
            return self._is_asked
        whole_deg = 360.0 * self.plan.turns
        if abs(move.angle_deg) < MOVED_DEG:
            if move.seconds > NO_TURN_S:
                raise CalibrationError(f"no turn came within {NO_TURN_S:g} s")
            return False
        return abs(abs(move.angle_deg) - whole_deg) < MOVED_DEG or move.still_s > HALF_WAY_S

    def _keep(self, new: Turns, done: FinishedMove, rest: RestMeasurement) -> None:
        self.turns.append(new)
        whole_deg = 360.0 * new.turns
        off = f"{100.0 * (abs(new.angle_deg) / whole_deg - 1.0):+.2f} %"
        self.say(f"  {new.angle_deg:+.2f} deg for {whole_deg:.0f}, {off}; up to {done.fastest_dps:.0f} deg/s")
        scales = scales_of(self.turns)
        is_pair = not new.is_ccw
        if scales is not None and is_pair:
            self.say(f"  {told(scales)}")
            if scales.spread <= self.plan.spread or scales.repeats >= self.plan.most:
                self.step = GuideStep.DONE
                return
        self._begin_move(rest, done.bias_dps, done.rest)

    def _refuse(self, error: CalibrationError) -> None:
        """By hand it is done again; without, a run that was asked for is not done by halves."""
        if not self.plan.is_by_hand:
            raise error
        self.say(f"Not taken: {str(error).rstrip('.')}{'' if str(error).endswith('?') else '.'}")

    @property
    def _is_next_ccw(self) -> bool:
        return len(self.turns) % 2 == 0

    @property
    def _next_words(self) -> str:
        count = "one whole turn" if self.plan.turns == 1 else f"{self.plan.turns} whole turns"
        way = "counter-clockwise, seen from above" if self._is_next_ccw else "clockwise, back again"
        return f"{count} {way} ({len(self.turns) // 2 + 1} of {LEAST} to {self.plan.most})"


def told(scales: Scales) -> str:
    """Both directions with their spread, and how exact a stop at the mark was."""
    return (
        f"scale counter-clockwise {scales.scale_ccw:.5f} ± {scales.scale_ccw_se:.5f}, clockwise "
        f"{scales.scale_cw:.5f} ± {scales.scale_cw_se:.5f}; a stop at the mark ± {scales.mark_deg:.2f} deg"
    )
