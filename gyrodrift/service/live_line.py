"""The line that `serve` shows on a terminal in place of JSON: yaw, sigma, bias, rest and link, updated in place."""

import errno
from collections.abc import Mapping
from math import isfinite

from gyrodrift.io.terminal import line_in_place
from gyrodrift.io.waiting import send_unwaiting
from gyrodrift.link.link import Link
from gyrodrift.service.listener import NO_WAKES, IdleListener, ReaderGoneError
from gyrodrift.values.errors import printable
from gyrodrift.values.sample import Attitude, Corrected

SILENT_S = 2.0
"""A link without samples for this long is called silent, s."""

RATE_S = 2.0
"""The sample rate is the mean over at least this time, s."""


class ServiceLine(IdleListener):
    """Writes the newest corrected sample and the state of the link on one line, with each tick.

    Parameters
    ----------
    fd
        Descriptor of the terminal; it is not closed here.
    """

    def __init__(self, link: Link, fd: int) -> None:
        self._link, self._fd = link, fd
        self._last: Corrected | None = None
        self._device: Corrected | None = None
        self._marks: list[tuple[float, int]] = []

    @property
    def is_wanted(self) -> bool:
        """The person at the terminal started the service."""
        return True

    def wakes(self) -> Mapping[int, int]:
        """No descriptor: a terminal that takes nothing now gets the next line."""
        return NO_WAKES

    def take(self, samples: list[Corrected]) -> None:
        """Keep the newest sample, and the newest one with the device's own yaw."""
        if samples:
            self._last = samples[-1]
            own = next((corrected for corrected in reversed(samples) if corrected.sample.device_yaw), None)
            self._device = own or self._device

    def tick(self, now_s: float) -> None:
        """Rewrite the line."""
        self._marks.append((now_s, self._link.counters.samples))
        while len(self._marks) > 2 and now_s - self._marks[1][0] >= RATE_S:
            del self._marks[0]
        self._write(line_in_place(self.text(), self._fd))

    def text(self) -> str:
        """The line, of printable characters only."""
        if self._last is None:
            return printable(f"waiting for samples on {self._link.name}")
        last, (begin_s, begin), (now_s, now) = self._last, self._marks[0], self._marks[-1]
        rate_hz = (now - begin) / max(now_s - begin_s, 1e-9)
        parts = [
            f"yaw {_signed(last.yaw_deg, 2)}{_margin(last.yaw_sigma_deg, 2)} deg",
            _device(self._device),
            _tilt(last.attitude),
            f"bias {_signed(last.bias_dps, 3)} deg/s",
            f"rest {100.0 * last.rest_probability:.0f} %" if isfinite(last.rest_probability) else "",
            f"{rate_hz:.1f} Hz",
            self._link_words(),
        ]
        return "   ".join(filter(None, parts))

    def finish(self) -> None:
        """End the line; the last values stay on the screen."""
        if self._last is not None:
            self._write("\r\n")

    def _link_words(self) -> str:
        silent_s = self._link.silent_s()
        if silent_s > SILENT_S:
            return f"silent for {silent_s:.0f} s"
        lost, decoder = self._link.counters.missing, self._link.decoder
        damaged = decoder.counters.damaged if decoder else 0
        return f"{lost} lost, {damaged} damaged" if lost or damaged else "link ok"

    def _write(self, text: str) -> None:
        rest = text.encode()
        try:
            while rest and (sent := send_unwaiting(self._fd, rest)):  # after `su` a terminal takes one byte at a time
                rest = rest[sent:]
        except OSError as error:
            if error.errno in (errno.EPIPE, errno.EIO):
                raise ReaderGoneError from error
            raise


def _signed(value: float, digits: int) -> str:
    return f"{round(value, digits) + 0.0:+.{digits}f}"  # + 0.0: no -0.00


def _tilt(attitude: Attitude | None) -> str:
    if attitude is None:
        return ""
    return f"roll {_signed(attitude.roll_deg, 1)} pitch {_signed(attitude.pitch_deg, 1)} deg"


def _device(last: Corrected | None) -> str:
    """The device's own yaw, and how far ours is from it."""
    if last is None or last.sample.device_yaw is None:
        return ""
    yaw_deg, sigma_deg, _ = last.sample.device_yaw
    margin, difference = _margin(sigma_deg, 2), _signed(last.device_difference_deg, 2)
    return f"device {_signed(yaw_deg, 2)}{margin} deg, difference {difference}"


def _margin(sigma: float, digits: int) -> str:
    return f" ± {sigma:.{digits}f}" if isfinite(sigma) else ""
