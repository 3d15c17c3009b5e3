"""Effects of platform and encoder: errors of the reference."""

from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from firmware_sim.effects.effect import Act, Effect, EffectSlot, Floats, Moments, Rng
from firmware_sim.effects.recursion import Poisson


class EncoderEccentricity(Effect):
    """Angle + A·sin(θ + φ): the disc is off center. Typical A: 0.1 to 1.4°."""

    name: Literal["encoder_eccentricity"] = "encoder_eccentricity"
    amplitude_deg: Annotated[float, Field(ge=0.0, le=20.0)]
    phase_deg: Annotated[float, Field(ge=-360.0, le=360.0)] = 0.0
    stage: ClassVar[str] = "encoder"
    slot: ClassVar[EffectSlot] = EffectSlot.ENCODER
    typical: ClassVar[dict[str, float]] = {"amplitude_deg": 0.5, "phase_deg": 30.0}
    small: ClassVar[dict[str, float]] = {"amplitude_deg": 0.1, "phase_deg": 30.0}

    def begin(self, rng: Rng, sample_rate_hz: float) -> Act:
        """Sine of the true angle."""
        return lambda angle, m: angle + self.amplitude_deg * np.sin(np.deg2rad(m.angle_deg + self.phase_deg))


class EncoderSlip(Effect):
    """The encoder jumps by ± a step at random times and stays there. Typical: 0.1 to 5°, a few times an hour."""

    name: Literal["encoder_slip"] = "encoder_slip"
    step_deg: Annotated[float, Field(ge=0.0, le=360.0)]
    per_hour: Annotated[float, Field(gt=0.0, le=36000.0)] = 20.0
    stage: ClassVar[str] = "encoder"
    slot: ClassVar[EffectSlot] = EffectSlot.ENCODER
    typical: ClassVar[dict[str, float]] = {"step_deg": 2.0, "per_hour": 20.0}
    small: ClassVar[dict[str, float]] = {"step_deg": 0.3, "per_hour": 20.0}

    def begin(self, rng: Rng, sample_rate_hz: float) -> Act:
        """Sum of the jumps so far; signs are drawn one by one."""
        jumps = Poisson(rng, 3600.0 / self.per_hour)
        ways = np.random.default_rng(rng.integers(1 << 62))
        offsets_deg = [0.0]

        def act(angle: Floats, moments: Moments) -> Floats:
            counts = jumps.count_until(moments.t_s).astype(np.int64)
            while len(offsets_deg) <= counts[-1]:
                offsets_deg.append(offsets_deg[-1] + self.step_deg * float(ways.choice([-1.0, 1.0])))
            shifted: Floats = angle + np.array(offsets_deg)[counts]
            return shifted

        return act


class Backlash(Effect):
    """Play between table and encoder: the encoder stays within half of it of the true angle. Typical: 0.02 to 0.5°."""

    name: Literal["backlash"] = "backlash"
    play_deg: Annotated[float, Field(ge=0.0, le=20.0)]
    stage: ClassVar[str] = "platform"
    slot: ClassVar[EffectSlot] = EffectSlot.ENCODER
    typical: ClassVar[dict[str, float]] = {"play_deg": 0.3}
    small: ClassVar[dict[str, float]] = {"play_deg": 0.08}

    def begin(self, rng: Rng, sample_rate_hz: float) -> Act:
        """Play operator, one direction at a time, starting in the middle of the play."""
        state = [float("nan")]

        def act(angle: Floats, _: Moments) -> Floats:
            followed = float(angle[0]) if state[0] != state[0] else state[0]
            ways = np.sign(np.diff(angle, prepend=angle[0]))
            turns = np.flatnonzero(np.diff(ways)) + 1
            out = np.empty_like(angle)
            for start, end in zip([0, *turns], [*turns, len(angle)], strict=True):
                stretch = angle[start:end]
                low, high = stretch - self.play_deg / 2.0, stretch + self.play_deg / 2.0
                out[start:end] = np.minimum(np.maximum(followed, low), high)
                followed = float(out[end - 1])
            state[0] = followed
            return out

        return act


class EncoderQuantization(Effect):
    """Fewer counts per turn than the rig states. Typical: 360 to 4096."""

    name: Literal["encoder_quantization"] = "encoder_quantization"
    cpr: Annotated[int, Field(ge=1, le=10_000_000)]
    stage: ClassVar[str] = "encoder"
    slot: ClassVar[EffectSlot] = EffectSlot.COUNTS
    typical: ClassVar[dict[str, float]] = {"cpr": 720}
    small: ClassVar[dict[str, float]] = {"cpr": 4096}

    def begin(self, rng: Rng, sample_rate_hz: float) -> Act:
        """Nearest coarse count."""
        return lambda angle, _: np.floor(angle / 360.0 * self.cpr + 0.5) * (360.0 / self.cpr)
