"""Send frames through a pty at their times, or as fast as they are read."""

import signal
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from firmware_sim.pty import PtyDevice
from firmware_sim.wire.encoder import Frame

LONGEST_NAP_S = 0.05


def play(
    frames: Iterator[Frame],
    device: PtyDevice,
    speed: float | None,
    is_over: Callable[[], bool] = lambda: False,
) -> tuple[int, int]:
    """Send frames at their times.

    Parameters
    ----------
    speed
        Device seconds per second; None for as fast as the reader reads, without loss.

    Returns
    -------
    tuple[int, int]
        Measurements sent, and measurements lost without a reader, or with a slow one.
    """
    sent = lost = 0
    origin_s = time.monotonic()
    for frame in frames:
        if is_over():
            break
        if speed is None:
            has_gone = _send_as_read(frame, device, is_over)
        else:
            _wait_until(origin_s + frame.t_s / speed, is_over)
            device.live_until(frame.t_s)
            has_gone = device.send(frame.content)
        sent += frame.rows if has_gone else 0
        lost += frame.rows if has_gone is False else 0
    return sent, lost


def play_after_each_opening(
    frames: Callable[[], Iterator[Frame]],
    device: PtyDevice,
    speed: float | None,
    is_over: Callable[[], bool],
) -> tuple[int, int]:
    """Send all frames from the first to each reader that opens the port; counts as `play`.

    The device is off without a reader. It stays off after the last frame until the reader leaves.
    """
    sent = lost = 0
    has_left = False

    def is_off() -> bool:
        nonlocal has_left
        has_left = has_left or not device.has_reader()
        return has_left or is_over()

    while not is_over():
        device.wait_for_reader(is_over)
        has_left = False
        counts = play(frames(), device, speed, is_off)
        sent, lost = sent + counts[0], lost + counts[1]
        while not is_off():
            time.sleep(LONGEST_NAP_S)
    return sent, lost


def _wait_until(due_s: float, is_over: Callable[[], bool]) -> None:
    while (early_s := due_s - time.monotonic()) > 0.0 and not is_over():
        time.sleep(min(early_s, LONGEST_NAP_S))


def _send_as_read(frame: Frame, device: PtyDevice, is_over: Callable[[], bool]) -> bool | None:
    """Send at the pace of the reader; False if the cable is unplugged, None if it is over."""
    if device.is_pulled_at(frame.t_s):
        device.drain(is_over)
    device.live_until(frame.t_s)
    if not device.is_plugged:
        return False
    while not (has_gone := device.send_all(frame.content, is_over)) and not is_over():
        device.wait_for_reader(is_over)
    return has_gone or None


@contextmanager
def stopped_by_signals() -> Iterator[Callable[[], bool]]:
    """Function that is true after SIGINT or SIGTERM."""
    received: list[int] = []
    numbers = (signal.SIGINT, signal.SIGTERM)
    old = [signal.signal(number, lambda number, _frame: received.append(number)) for number in numbers]
    try:
        yield lambda: bool(received)
    finally:
        for number, handler in zip(numbers, old, strict=True):
            signal.signal(number, handler)
