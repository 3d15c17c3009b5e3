"""Steps of a calibration of three axes: six sides in any order, and whole turns on the sides if requested.

The guide takes samples and waits for no key. Each rest is a new side, or the end of a turn on the same side.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from datetime import datetime
from typing import Any

from gyrodrift.calibrate.guide import GuideStep, Key
from gyrodrift.calibrate.positions.accelerometer import AccelerometerFit, check_size
from gyrodrift.calibrate.positions.block import AXES, TILT_MAX_DEG, AxesRest, SideUp, side_up
from gyrodrift.calibrate.positions.matrix import AxisTurn, MatrixFit, check_axes
from gyrodrift.calibrate.positions.measurements import AxesMove, MeasuredTurn, Measurements, move_between, over
from gyrodrift.calibrate.positions.rests import Laid, RestFinder
from gyrodrift.calibrate.scale import Turns, check_turns
from gyrodrift.values.calibration import Calibration
from gyrodrift.values.errors import CalibrationError
from gyrodrift.values.sample import Sample

TURN_MIN_DEG = 90.0
"""Angle about the vertical from which a move on a side counts as a turn, deg."""

NO_STEP_S = 120.0
"""Without a user, the calibration ends if nothing new was measured for this long, s."""


@dataclass(frozen=True, slots=True)
class PositionPlan:
    """Requested calibration.

    has_turns, turns
        Whether the board is turned about each axis, and whole turns at a time.
    rest_s
        Length of a rest on a side, s.
    is_by_hand
        Whether a user reads the instructions and may press keys.
    """

    has_turns: bool = False
    turns: int = 1
    rest_s: float = 2.0
    is_by_hand: bool = True


@dataclass(slots=True)
class PositionGuide:
    """State of the calibration; `say` gets every instruction and result as a sentence."""

    plan: PositionPlan
    say: Callable[[str], object]
    step: GuideStep = GuideStep.READY
    _finder: RestFinder = field(init=False)
    _so_far: Measurements = field(init=False)
    _waits_since_s: float | None = None

    def __post_init__(self) -> None:
        self._finder, self._so_far = RestFinder(self.plan.rest_s), Measurements(self.plan.has_turns)

    def begin(self) -> None:
        """Start, with the instructions."""
        plan, self.step = self.plan, GuideStep.REST
        self._say_all(_instructions(plan))

    def take(self, samples: list[Sample], clipped: int = 0) -> None:
        """Add samples; `clipped` of them were marked as out of range by the device.

        Raises
        ------
        CalibrationError
            The device has no accelerometer, gravity contradicts the gyro, or nothing is measured without a user.
        """
        for laid in self._finder.take(samples, clipped):
            if self.step is not GuideStep.DONE:
                self._lay(laid)
        if samples and self.step is not GuideStep.DONE:
            self._check_wait(samples[-1].t_device_s)

    def press(self, key: Key) -> None:
        """Handle an input line of the user; Enter is not needed."""
        if key is Key.UNDO and (name := self._so_far.undo()):
            self.say(f"Removed {name}; left: {self._so_far.missing_text}.")
        elif key is Key.ENOUGH:
            self._end_early()

    @property
    def line(self) -> str:
        """Current state, for the status line."""
        still_s = self._finder.still_s
        return f"{f'at rest {still_s:.1f} s' if still_s else 'moving'}; left: {self._so_far.missing_text}"

    def result(self, now: datetime, device_id: str, dps_per_lsb: float | None) -> Calibration:
        """Calibration from all sides and turns; `dps_per_lsb` as the device states it, or None.

        Raises
        ------
        CalibrationError
            Sides are missing, or the results are impossible.
        """
        return self._so_far.calibration(now, device_id, dps_per_lsb)

    def measured(self) -> dict[str, Any]:
        """Measurements for JSON, after `result`."""
        return self._so_far.measured()

    @staticmethod
    def merged(new: Calibration, old: Calibration | None) -> Calibration:
        """A result, with the values of a replaced calibration that were not measured."""
        return over(new, old)

    def _lay(self, laid: Laid) -> None:
        """Handle a rest: a side, a turn, or neither."""
        check_size(laid.rest)
        position = side_up(laid.rest.accel_mps2)
        if position.tilt_deg > TILT_MAX_DEG:
            self.say(
                f"Not accepted: {position.side} is {position.tilt_deg:.0f} deg off the vertical, and "
                f"{TILT_MAX_DEG:.0f} deg are allowed. Lay it on a side."
            )
            return
        move = move_between(laid.before, laid.rest, laid.move) if laid.before is not None and laid.move else None
        is_same_side = move is not None and side_up(move.before.accel_mps2).side == position.side
        if move is not None and is_same_side and self._is_turn(move):
            self._take_turn(move, position, is_whole=laid.is_whole)
            return
        if move is not None and not is_same_side and laid.is_whole:
            self._so_far.moves.append(move)
            self._so_far.check_gravity()
        self._take_side(laid.rest, position)

    def _is_turn(self, move: AxesMove) -> bool:
        return self.plan.has_turns and abs(move.up_angle_deg) >= TURN_MIN_DEG

    def _take_turn(self, move: AxesMove, position: SideUp, *, is_whole: bool) -> None:
        turn = AxisTurn(position.axis, self.plan.turns, move.up_angle_deg, move.angles_deg)
        try:
            self._check_turn(turn, move, is_whole=is_whole)
        except CalibrationError as error:
            end = "" if str(error).endswith("?") else "."
            self.say(f"Not accepted: {error}{end} Stop at the mark, and turn again.")
            return
        self._so_far.order.append(MeasuredTurn(turn, move))
        self._go_on(f"turn about {AXES[turn.axis]} reads {turn.up_angle_deg:+.2f} deg for {360 * turn.turns}")
        self._finish_when_complete()

    def _check_turn(self, turn: AxisTurn, move: AxesMove, *, is_whole: bool) -> None:
        if not is_whole:
            raise CalibrationError("samples were lost, or out of the range of the device: turn more slowly")
        if not move.is_on_table:
            raise CalibrationError(f"the board was tipped by {move.tipped_deg:.0f} deg: it has to stay on the table")
        same_axis = [before for before in self._so_far.turns if before.axis == turn.axis]
        earlier = [Turns(before.is_ccw, before.turns, before.up_angle_deg) for before in same_axis]
        check_turns(Turns(turn.is_ccw, turn.turns, turn.up_angle_deg), earlier)

    def _take_side(self, rest: AxesRest, position: SideUp) -> None:
        is_new = position.side in self._so_far.missing_sides
        self._so_far.order.append(rest)
        if not is_new:
            self.say(f"  {position.side} up once more")
            return
        x, y, z = rest.accel_mps2
        self._go_on(f"{position.side} up: {x:+.3f}, {y:+.3f}, {z:+.3f} m/s²")
        if not self._so_far.missing_sides:
            self._say_all(_accelerometer_sentences(self._so_far.accelerometer()))
        self._finish_when_complete()

    def _go_on(self, sentence: str) -> None:
        """Tell a new measurement, and what is left."""
        self._waits_since_s = None
        self.say(f"  {sentence}" + ("" if self._so_far.is_complete else f"; left: {self._so_far.missing_text}"))

    def _finish_when_complete(self) -> None:
        if not self._so_far.is_complete:
            return
        try:
            matrix = self._so_far.matrix(self._so_far.accelerometer())
        except CalibrationError as error:
            if not self.plan.is_by_hand:
                raise
            self.say(f"Not accepted: {error}. u removes the last turn; more turns improve the mean.")
            return
        self._say_all([] if matrix is None else _matrix_sentences(matrix))
        error_deg = self._so_far.gravity_error_deg()
        if error_deg is not None:
            self.say(f"  gravity turns as the gyro says, within {error_deg:.1f} deg")
        self.step = GuideStep.DONE

    def _check_wait(self, now_s: float) -> None:
        if self._waits_since_s is None:
            self._waits_since_s = now_s
        if not self.plan.is_by_hand and now_s - self._waits_since_s > NO_STEP_S:
            raise CalibrationError(
                f"nothing new was measured within {NO_STEP_S:g} s; left: {self._so_far.missing_text}"
            )

    def _end_early(self) -> None:
        """End with the sides so far; turns that determine no matrix are left out, and the reason is told."""
        if self.plan.has_turns and not self._so_far.missing_sides:
            try:
                check_axes(self._so_far.turns)
                self._so_far.matrix(self._so_far.accelerometer())
            except CalibrationError as error:
                self.say(f"The matrix of the gyro is left out: {error}.")
                self._so_far.forget_turns()
        self.step = GuideStep.DONE

    def _say_all(self, sentences: Iterable[str]) -> None:
        for sentence in sentences:
            self.say(sentence)


def _instructions(plan: PositionPlan) -> Iterator[str]:
    yield (
        f"Lay the board down on each of its six sides, in any order, and let go for {plan.rest_s + 1.0:.0f} s. A side "
        "may be askew: lean the board against a book."
    )
    if plan.has_turns:
        turns = "one whole turn" if plan.turns == 1 else f"{plan.turns} whole turns"
        yield (
            f"Once with x, once with y and once with z upright, also turn it {turns} on the table, stop at a mark, and "
            "turn it back."
        )
    if plan.is_by_hand:
        yield "u removes the last measurement, q ends the calibration."


def _accelerometer_sentences(fit: AccelerometerFit) -> Iterator[str]:
    yield f"  accelerometer offset {_entries(fit.offset_mps2, fit.offset_se_mps2, '.3f')} m/s²"
    yield f"  accelerometer scale {_entries(fit.scale, fit.scale_se, '.4f')}"


def _matrix_sentences(fit: MatrixFit) -> Iterator[str]:
    for axis, row, errors in zip(AXES, fit.matrix, fit.matrix_se, strict=True):
        yield f"  gyro {axis} = {_entries(row, errors, '.4f')}"
    yield f"  stops at the mark ± {fit.mark_deg:.2f} deg"


def _entries(values: Iterable[float], errors: Iterable[float], form: str) -> str:
    return ", ".join(
        f"{name} {value:+{form}} ± {error:{form}}" for name, value, error in zip(AXES, values, errors, strict=True)
    )
