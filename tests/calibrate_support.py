"""A simulated table that is turned when a test says so: firmware_sim on a pty, played move by move."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Self

from support import never

from firmware_sim.effects.effect import Effect
from firmware_sim.measure import measure
from firmware_sim.motion.profile import load_profile
from firmware_sim.pty import PtyDevice
from firmware_sim.rig import Base, Rig, parse_effect
from firmware_sim.wire.encoder import Frame
from firmware_sim.wire.registry import ENCODERS

TURN_DPS = 90.0
RAMP_S = 1.0

SCALED = ("scale_factor:error_percent=1.5", "scale_asymmetry:error_percent=0.4")
GAIN_CCW, GAIN_CW = 1.015 + 0.004, 1.015 - 0.004
"""Measured rate of a true rate: scale first, then the error that depends on the direction."""


def rest(seconds: float) -> list[str]:
    return [f"{{kind: rest, seconds: {seconds}}}"]


def turn(angle_deg: float) -> list[str]:
    """So far, at 90 deg/s or less; degrees, counter-clockwise positive."""
    rate_dps = angle_deg / (turn_s(angle_deg) - RAMP_S)
    return [
        f"{{kind: ramp, seconds: {RAMP_S}, to_dps: {rate_dps}}}",
        f"{{kind: hold, seconds: {angle_deg / rate_dps - RAMP_S}}}",
        f"{{kind: ramp, seconds: {RAMP_S}, to_dps: 0}}",
    ]


def turn_s(angle_deg: float) -> float:
    return max(abs(angle_deg) / TURN_DPS, 2.0 * RAMP_S) + RAMP_S


def profile_of(segments: list[str], folder: Path) -> Path:
    path = folder / "turns.yaml"
    path.write_text(
        "\n".join(["about: turns against a mark", "segments:", *(f"  - {segment}" for segment in segments)])
    )
    return path


def to_and_fro(angles_deg: list[float], first_s: float = 14.0) -> list[str]:
    """A rest, then moves with a stop of 4 s behind each."""
    return [*rest(first_s), *(item for angle_deg in angles_deg for item in (*turn(angle_deg), *rest(4.0)))]


def effects(texts: tuple[str, ...]) -> list[Effect]:
    return [parse_effect(text) for text in texts]


@dataclass
class Table:
    """A device on a table: moves are played as fast as they are read, in the order in which they were laid out."""

    device: PtyDevice
    folder: Path
    segments: list[str]
    effects: tuple[str, ...] = SCALED
    t_s: float = 0.0
    _frames: Iterator[Frame] = field(init=False)
    _next: Frame = field(init=False)

    def __post_init__(self) -> None:
        base = Base(bias_dps=0.35, host_delay_s=0.0)
        rig, profile = Rig(base=base, effects=tuple(effects(self.effects))), profile_of(self.segments, self.folder)
        native = ENCODERS["native"]
        self.device.greeting = native.hello(base)
        self._frames = native.frames(measure(rig, load_profile(str(profile)), 1), base)
        self._next = next(self._frames)

    def play(self, seconds: float) -> Self:
        """So much of what was laid out."""
        self.device.wait_for_reader(never)
        self.t_s += seconds
        content = b""
        while self._next.t_s < self.t_s:
            content += self._next.content
            self._next = next(self._frames)
        for start in range(0, len(content), 2000):
            self.device.send_all(content[start : start + 2000], never)
        return self
