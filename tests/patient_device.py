"""The simulated device with a clock that waits for its reader: `python -m tests.patient_device --link PATH --speed 5`.

At no load of the machine does it lose a sample, or send what the reader gets in one piece.
"""

import sys
import time
from collections.abc import Callable, Iterator

from firmware_sim import __main__, command, player
from firmware_sim.pty import PtyDevice
from firmware_sim.wire.encoder import Frame


def play(
    frames: Iterator[Frame], device: PtyDevice, speed: float | None, is_over: Callable[[], bool]
) -> tuple[int, int]:
    return player.play(frames if speed is None else _paced(frames, device, speed, is_over), device, None, is_over)


def _paced(frames: Iterator[Frame], device: PtyDevice, speed: float, is_over: Callable[[], bool]) -> Iterator[Frame]:
    """Frames at their times, which go on while the reader has read everything."""
    due_s, last_s = time.monotonic(), 0.0
    for frame in frames:
        due_s, last_s = due_s + (frame.t_s - last_s) / speed, frame.t_s
        player._wait_until(due_s, is_over)
        while device.has_reader() and not device._reader_is_done() and not is_over():
            time.sleep(0.001)
            due_s = max(due_s, time.monotonic())
        yield frame


if __name__ == "__main__":
    setattr(command, "play", play)  # noqa: B010 - the command has it from the player, and does not export it
    sys.exit(__main__.main())
