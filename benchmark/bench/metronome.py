"""A device in a process of its own, which sends frames evenly, or as fast as they are read, and notes when.

Frames are encoded beforehand, so that sending disturbs as little as it can. Paced frames are timed just before
they are handed to the pty: what is measured from then on includes the write.
"""

import gc
import json
import sys
import time
from array import array
from pathlib import Path

from support import never

from bench import harness
from firmware_sim.pty import PtyDevice


def main(port: Path, result: Path, count: int, rate_hz: float, protocol: str) -> None:
    """Speak, and write down what was done once the reader has taken all of it."""
    if rate_hz:
        encode = harness.axes_frames if protocol == "axes" else harness.native_frames
        frames = encode(count, round(1e6 / rate_hz))
    else:
        turn = {"native": harness.native_frames, "csv": harness.csv_lines}[protocol]
        frames = turn(min(count, harness.ROUND_SAMPLES), harness.ROUND_PERIOD_US)
    device = PtyDevice(port)
    gc.freeze()
    gc.disable()
    device.wait_for_reader(never)
    if protocol == "native":
        device.send(harness.hello(rate_hz or 100.0))
    if protocol == "axes":
        device.send(harness.axes_hello(rate_hz))
    times_s = array("d")
    started_s = time.monotonic()
    refused = paced(device, frames, rate_hz, times_s) if rate_hz else flood(device, frames, count)
    seconds = time.monotonic() - started_s
    device.drain()
    result.with_suffix(".times").write_bytes(times_s.tobytes())
    result.write_text(json.dumps({"refused": refused, "seconds": seconds}))
    device.close()


def paced(device: PtyDevice, frames: list[bytes], rate_hz: float, times_s: "array[float]") -> int:
    """Each frame at its time; how many the pty was too full to take."""
    refused = 0
    origin_s = time.monotonic()
    for number, frame in enumerate(frames):
        early_s = origin_s + number / rate_hz - time.monotonic()
        if early_s > 0.0:
            time.sleep(early_s)
        times_s.append(time.monotonic())
        refused += not device.send(frame)
    return refused


def flood(device: PtyDevice, frames: list[bytes], count: int) -> int:
    """All frames, round after round, none refused."""
    rounds, rest = divmod(count, len(frames))
    assert not rest, f"{count} is no whole number of rounds of {len(frames)}"
    chunks = harness.in_chunks(b"".join(frames))
    for _ in range(rounds):
        for chunk in chunks:
            device.send_all(chunk, never)
    return 0


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]), int(sys.argv[3]), float(sys.argv[4]), sys.argv[5])
