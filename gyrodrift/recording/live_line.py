"""Status line of a recording on the terminal."""

import sys
from contextlib import suppress
from typing import Any, TextIO

from gyrodrift.filters.run import FilterRun
from gyrodrift.io.terminal import line_in_place
from gyrodrift.link.link import Link
from gyrodrift.recording.recorder import Recorder
from gyrodrift.values.calibration import NO_CALIBRATION, Calibration, of_this_device
from gyrodrift.values.errors import printable
from gyrodrift.values.sample import Sample


class LiveYaw:
    """Runs a filter over the samples for the line, after the calibration if it belongs to their device.

    The file has the samples as measured.
    """

    def __init__(self, run: FilterRun, calibration: Calibration | None = None) -> None:
        self._calibration = calibration
        self._run = run

    def take(self, samples: list[Sample], link: Link) -> None:
        """Filter samples of a link."""
        calibration, step = self._applied_to(link), self._run.step
        for sample in map(calibration.sample, samples):
            step(sample.t_device_s, sample.rate_dps, sample.inertial, sample.still, sample.temp_c)

    def _applied_to(self, link: Link) -> Calibration:
        return of_this_device(self._calibration, link.device.device_id, link.name) or NO_CALIBRATION

    @property
    def text(self) -> str:
        """Yaw as the live line shows it."""
        return f"yaw {round(self._run.state.yaw_deg, 1) + 0.0:+.1f} deg"  # no −0.0


class LiveLine:
    """Time, yaw, sample rate, gaps, damaged frames, size and free space; rewritten with every tick."""

    def __init__(self, link: Link, recorder: Recorder, yaw: LiveYaw, stream: TextIO = sys.stderr) -> None:
        self._link = link
        self._recorder = recorder
        self._yaw = yaw
        self._stream = stream
        self._first_s: float | None = None
        self._marks: list[tuple[float, int, int]] = []

    def take(self, samples: list[Sample]) -> None:
        """Filter samples for yaw; the rest comes from counters."""
        self._yaw.take(samples, self._link)

    def tick(self, now_s: float) -> None:
        """Rewrite the line."""
        self._marks = [*self._marks[-8:], (now_s, self._recorder.samples, self._recorder.size_bytes)]
        if self._recorder.samples and self._first_s is None:
            self._first_s = now_s
        self._show(self.text(now_s))

    def text(self, now_s: float) -> str:
        """Text of the line."""
        if self._first_s is None:
            return printable(f"waiting for samples on {self._link.name}")
        (then_s, samples, size), (_, samples_now, size_now) = self._marks[0], self._marks[-1]
        elapsed_s = max(now_s - then_s, 1e-9)
        counters, decoder = self._link.counters, self._link.decoder
        parts = [
            _clock(now_s - self._first_s),
            self._yaw.text,
            f"{(samples_now - samples) / elapsed_s:.1f} Hz",
            f"{samples_now} samples",
            f"{counters.gaps} gaps",
            f"{decoder.counters.damaged if decoder else 0} damaged",
            f"{size_now / 1e6:.1f} MB",
            _disk(self._recorder.left_bytes, (size_now - size) / elapsed_s),
        ]
        return "   ".join(parts)

    def stats(self) -> dict[str, Any]:
        """No fields for the log."""
        return {}

    def close(self) -> None:
        """Clear the line."""
        self._show("")

    def _show(self, text: str) -> None:
        with suppress(OSError):  # a closed terminal does not end a recording
            self._stream.write(line_in_place(text, self._stream))
            self._stream.flush()


def _clock(seconds: float) -> str:
    minutes, seconds = divmod(int(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{seconds:02d}"


def _disk(left_bytes: int | None, bytes_per_s: float) -> str:
    if left_bytes is None:
        return "disk gone"
    text = f"{left_bytes / 1e9:.1f} GB left"
    if bytes_per_s <= 0.0:
        return text
    hours = left_bytes / bytes_per_s / 3600.0
    return f"{text} for {hours:.0f} h" if hours < 72 else f"{text} for {hours / 24:.0f} days"
