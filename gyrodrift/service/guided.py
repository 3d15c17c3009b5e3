"""A calibration of the running service, guided step by step through the control socket: `ctl calibrate`."""

from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from importlib import import_module
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING, Any

from gyrodrift.io.files import UnreadableError, read_ordinary, write_whole
from gyrodrift.service.calibrating import bias_of
from gyrodrift.service.listener import IdleListener
from gyrodrift.service.pipeline import Pipeline
from gyrodrift.values.calibration import Calibration, device_identity
from gyrodrift.values.errors import CalibrationError, UsageError
from gyrodrift.values.sample import Sample

if TYPE_CHECKING:  # brings numpy, which a service does not need before somebody calibrates
    from gyrodrift.calibrate.guide import Guide
    from gyrodrift.calibrate.positions.guide import PositionGuide
    from gyrodrift.config.watch import ConfigWatch

    AnyGuide = Guide | PositionGuide

START, POSITIONS, AXIS_TURNS = "start", "positions", "axis-turns"
"""Calibrations: turns about the vertical, six positions, and six positions with turns about each axis."""

GUIDES = {
    START: "gyrodrift.calibrate.guide",
    POSITIONS: "gyrodrift.calibrate.positions.guide",
    AXIS_TURNS: "gyrodrift.calibrate.positions.guide",
}
UNATTENDED_S = 300.0
"""A calibration without a key or a new sentence for this long ends, s: its samples are kept in memory. A turn takes
seconds. Chosen."""

SILENT_S = 10.0
"""A link without samples for this long ends a calibration, as in `gyrodrift calibrate`, s."""

KEPT_SENTENCES = 8

Answer = Mapping[str, Any]


@dataclass(slots=True)
class GuidedCalibration(IdleListener):
    """Hears the samples as measured, and writes the result into the config of the service.

    Without a config, or if it cannot be written, the result is applied until the service ends.
    """

    pipeline: Pipeline
    watch: "ConfigWatch | None" = None
    _guide: "AnyGuide | None" = None
    _says: deque[str] = field(default_factory=lambda: deque(maxlen=KEPT_SENTENCES))
    _clipped: int = 0
    _unattended_since_s: float | None = None
    _device_id: str = ""

    def start(self, kind: str = START) -> Callable[[], Answer | None]:
        """Begin a calibration; the answer waits until the packages are loaded.

        Raises
        ------
        CalibrationError
            From the answer, if a calibration runs already.
        """
        loading = Thread(target=import_module, args=(GUIDES[kind],), daemon=True)
        loading.start()

        def answer() -> Answer | None:
            if loading.is_alive():
                return None
            if self._guide is not None:
                raise CalibrationError("a calibration runs already; finish or cancel it first")
            self._says.clear()
            self._unattended_since_s, self._device_id = None, ""
            self._guide = self._guide_of(kind)
            self._guide.begin()
            return self.state()

        return answer

    def _guide_of(self, kind: str) -> "AnyGuide":
        if kind == START:
            from gyrodrift.calibrate.guide import CalibrationPlan, Guide  # noqa: PLC0415 - loaded by the thread

            return Guide(CalibrationPlan(), self._say)
        from gyrodrift.calibrate.positions.guide import PositionGuide, PositionPlan  # noqa: PLC0415 - as above

        return PositionGuide(PositionPlan(has_turns=kind == AXIS_TURNS), self._say)

    def _say(self, sentence: str) -> None:
        self._says.append(sentence)
        self._unattended_since_s = None

    def press(self, word: str) -> Answer:
        """`mark` at a stop at the mark, `undo` the last turn, `finish` with the turns so far, `cancel` all.

        Raises
        ------
        CalibrationError
            If no calibration runs.
        """
        guide = self._guide
        if guide is None:
            raise CalibrationError("no calibration runs; begin with calibrate start")
        self._unattended_since_s = None
        if word == "cancel":
            self._end("Canceled; nothing is written.")
        else:
            from gyrodrift.calibrate.guide import Key  # noqa: PLC0415 - loaded already

            key = {"mark": Key.ENTER, "undo": Key.UNDO, "finish": Key.ENOUGH}[word]
            self._go_on(guide, lambda: guide.press(key))
        return self.state()

    def state(self) -> Answer:
        """Step of the guide (`idle` without one), the line about now, and the newest sentences."""
        guide = self._guide
        step, line = ("idle", "") if guide is None else (guide.step.value, guide.line)
        return {"step": step, "line": line, "says": list(self._says)}

    def take(self, samples: list[Sample]) -> None:
        """Hand samples to the guide."""
        guide, decoder = self._guide, self.pipeline.link.decoder
        if guide is None or not samples:
            return
        device_id = self.pipeline.link.device.device_id or self._device_id  # a name may come late
        if self._device_id not in ("", device_id):
            self._end("Another device is connected; nothing is written.")
            return
        self._device_id = device_id
        clipped = decoder.counters.clipped if decoder else 0
        newly_clipped, self._clipped = clipped - self._clipped, clipped
        self._go_on(guide, lambda: guide.take(samples, newly_clipped))

    def tick(self, now_s: float) -> None:
        """End a calibration whose device fell silent, or whose user has left."""
        if self._guide is None:
            return
        if self._unattended_since_s is None:
            self._unattended_since_s = now_s
        if self.pipeline.link.silent_s() > SILENT_S:
            self._end("The device fell silent; nothing is written.")
        elif now_s - self._unattended_since_s > UNATTENDED_S:
            self._end(f"No key for {UNATTENDED_S / 60.0:.0f} min; nothing is written.")

    def _end(self, sentence: str) -> None:
        self._guide = None
        self._says.append(sentence)

    def _go_on(self, guide: "AnyGuide", step: Callable[[], None]) -> None:
        """Carry out a step; a mistake in it ends the calibration and not the service."""
        try:
            step()
            self._finish_when_done(guide)
        except CalibrationError as error:
            self._end(f"Nothing is written: {error}")
        except Exception as error:  # noqa: BLE001 - the filter and its outputs must go on
            reason = f"{type(error).__name__}: {error}"
            self.pipeline.log.error("calibration_failed", reason=reason)  # noqa: TRY400 - the reason says it
            self._end(f"Nothing is written: {reason}")

    def _finish_when_done(self, guide: "AnyGuide") -> None:
        from gyrodrift.calibrate.guide import GuideStep  # noqa: PLC0415 - loaded already

        if guide.step is not GuideStep.DONE:
            return
        link, watch = self.pipeline.link, self.watch
        try:
            device_id = device_identity(link.device.device_id, link.name)
            result = guide.result(datetime.now(UTC), device_id, link.device.dps_per_lsb)
        except CalibrationError as error:
            self._end(f"Nothing is written: {error}")
            return
        calibration = guide.merged(result, self.pipeline.calibrating.given)
        hint = "start serve with --config FILE to keep it"
        if watch is not None:
            try:
                _write(watch.path, calibration)
            except (UsageError, OSError) as error:  # the turns are not lost
                hint = f"it is not written: {error}"
            else:
                self._end(f"Written to {watch.path}; it is applied at once.")
                return
        self.pipeline.calibrating.follow(calibration, bias_of(self.pipeline.state))
        self._end(f"Applied until the service ends; {hint.rstrip('.')}.")


def _write(path: Path, calibration: Calibration) -> None:
    """Put the calibration into a config; all other lines stay. UsageError if the config has become unreadable."""
    from yaml import YAMLError  # noqa: PLC0415 - there is a config, so it is loaded, and so are the next two

    from firmware_sim.strict_yaml import LONGEST_BYTES  # noqa: PLC0415
    from gyrodrift.config.calibration import block_text, with_block  # noqa: PLC0415

    block = block_text(calibration)
    try:
        text = read_ordinary(path, LONGEST_BYTES).content.decode("utf-8-sig")
        write_whole(path, [with_block(text, block)])
    except (UsageError, UnreadableError) as error:
        raise UsageError(f"{path}: {error}") from error
    except (UnicodeDecodeError, YAMLError, RecursionError) as error:
        raise UsageError(f"{path}: is no YAML at present; correct it and calibrate again") from error
