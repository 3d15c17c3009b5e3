"""The motion to record next: for each effect in question, the maneuver in which it shows best.

The table follows from the equations of the effects. A lag shows in quick changes of the rate, and a scale error at
several speeds. A dead band shows near zero, and a wander of the bias at rest.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import floor, pi
from types import MappingProxyType
from typing import NamedTuple

import yaml

from firmware_sim.measure import COUNTS_MAX
from firmware_sim.motion.profile import Ambient, Profile, Segment
from firmware_sim.motion.segments import Ramp, Rest, Steps
from firmware_sim.motion.waves import Multisine
from firmware_sim.rig import Base

SHARE_OF_RANGE, FASTEST_DPS = 0.9, 300.0
"""Share of the range of the gyro that a motion uses, and the highest rate of a small turntable. Chosen: a tenth of the
range is left for bias and overshoot."""

WAVE_DPS, SLOWEST_HZ, FASTEST_HZ = 40.0, 0.2, 12.0
"""√2 times the RMS of a multisine, and its lowest and highest frequency. Chosen: a table with a load follows it; the
lowest is that of `config/profiles/identify.yaml`."""

RAMP_S, SHARP_S, HOLD_S, CREEP_S = 0.5, 0.1, 8.0, 2.0
"""Duration of a change of rate, of a sharp change, of a constant rate, and of the change before and after a slow ramp.
Chosen: as in `config/profiles/identify.yaml`; a constant rate lasts several blocks of a second."""

STILL_S = 5.0
"""Rest after power-on, with which each profile begins. Chosen: several blocks of a second show the bias."""

AIR_C, WARMER_C, WARMS_C_PER_S = 25.0, 12.0, 10.0 / 60.0
"""Temperature of the air, the most that it warms, and its slope. Chosen: a hair dryer or a box with a lamp warms as
quickly."""

Segments = list[Segment]


class MotionLimits(NamedTuple):
    """Highest rate in deg/s, and the frequency up to which multisines run, Hz."""

    rate_dps: float
    wave_hz: float


def limits_of(base: Base) -> MotionLimits:
    """Limits for the gyro and the encoder of a rig."""
    rate_dps = min(SHARE_OF_RANGE * COUNTS_MAX * base.dps_per_lsb, FASTEST_DPS)
    swing_deg = 4.0 * 360.0 / max(1, base.encoder_cpr)
    # Four counts from end to end are visible. A rate of amplitude a swings the angle by 2a / (2 pi f).
    resolvable_hz = min(WAVE_DPS, rate_dps) / (pi * swing_deg)
    wave_hz = min(resolvable_hz, 0.25 * base.sample_rate_hz, FASTEST_HZ)  # half of the Nyquist frequency
    return MotionLimits(rate_dps, max(wave_hz, 2.0 * SLOWEST_HZ))


@dataclass(frozen=True, slots=True)
class Maneuver:
    """A motion of any length.

    says
        Description in a few words for a person, from the limits.
    segments
        Segments of the motion from its length in s and the limits. It begins and ends at rest.
    warms_air
        Whether the air warms during the motion and cools again.
    """

    says: Callable[[MotionLimits], str]
    segments: Callable[[float, MotionLimits], Segments]
    warms_air: bool = False


def _steps(seconds: float, rates_dps: Sequence[float], ramp_s: float = RAMP_S, hold_s: float = HOLD_S) -> Segments:
    """Rates with both signs, in as many rounds as fit if each rate lasts about `hold_s`; exactly `seconds` long."""
    signed_dps = tuple(signed for rate_dps in rates_dps for signed in (rate_dps, -rate_dps))
    rates = signed_dps * max(1, round(seconds / (len(signed_dps) * (ramp_s + hold_s))))
    exact_hold_s = (seconds - ramp_s) / len(rates) - ramp_s
    return [Steps(kind="steps", rates_dps=rates, ramp_seconds=ramp_s, hold_seconds=exact_hold_s)]


def _speeds(seconds: float, limits: MotionLimits) -> Segments:
    return _steps(seconds, [share * limits.rate_dps for share in (0.05, 0.2, 0.5, 1.0)])


def _turns(seconds: float, limits: MotionLimits) -> Segments:
    """Whole turns both ways, slow ones in the first half and fast ones in the second."""
    return [part for rate_dps in (36.0, 0.7 * limits.rate_dps) for part in _both_ways(0.5 * seconds, rate_dps)]


def _both_ways(seconds: float, rate_dps: float) -> Segments:
    """Whole turns in one direction, the same number back, and rest for the remaining time; a part where none fits."""
    turn_s = 360.0 / rate_dps
    count = floor((seconds - 2.0 * RAMP_S) / (2.0 * turn_s))
    hold_s = count * turn_s - RAMP_S if count else 0.5 * seconds - 3.0 * RAMP_S
    turns: Segments = [
        Steps(kind="steps", rates_dps=(signed_dps,), ramp_seconds=RAMP_S, hold_seconds=hold_s)
        for signed_dps in (rate_dps, -rate_dps)
    ]
    return [*turns, Rest(kind="rest", seconds=seconds - sum(segment.seconds for segment in turns))]


def _quick(seconds: float, limits: MotionLimits) -> Segments:
    """Reversals for a third of the time, then a multisine."""
    sine_s, rms_dps = 2.0 / 3.0 * seconds, min(WAVE_DPS, limits.rate_dps) / 2.0**0.5
    sines = Multisine(
        kind="multisine", seconds=sine_s, rms_dps=rms_dps, from_hz=SLOWEST_HZ, to_hz=limits.wave_hz, tones=24
    )
    return [*_steps(seconds - sine_s, [0.3 * limits.rate_dps], SHARP_S, 1.0), sines]


def _through_zero(seconds: float, _: MotionLimits) -> Segments:
    parts = ((CREEP_S, -3.0), (seconds - 2.0 * CREEP_S, 3.0), (CREEP_S, 0.0))
    return [Ramp(kind="ramp", seconds=ramp_s, to_dps=rate_dps) for ramp_s, rate_dps in parts]


REST = Maneuver(lambda _: "rest", lambda seconds, _: [Rest(kind="rest", seconds=seconds)])
SPEEDS = Maneuver(lambda limits: f"steps of both signs at four speeds up to {limits.rate_dps:.0f} deg/s", _speeds)
WARM = Maneuver(lambda limits: f"{SPEEDS.says(limits)} in air that warms and cools", _speeds, warms_air=True)
TURNS = Maneuver(lambda limits: f"whole turns both ways at 36 and {0.7 * limits.rate_dps:.0f} deg/s", _turns)
QUICK = Maneuver(lambda limits: f"sharp reversals and a multisine to {limits.wave_hz:.3g} Hz", _quick)
REVERSALS = Maneuver(lambda _: "sharp reversals at 8 deg/s", lambda seconds, _: _steps(seconds, [8.0], SHARP_S, 1.0))
THROUGH_ZERO = Maneuver(lambda _: "a slow ramp through zero", _through_zero)

SHOWN_BY: Mapping[str, Maneuver] = MappingProxyType(
    {
        **dict.fromkeys(("bias_instability", "rate_random_walk", "popcorn", "spikes", "vibration"), REST),
        **dict.fromkeys(("temp_bias", "temp_scale", "warmup"), WARM),
        **dict.fromkeys(("g_sensitivity", "encoder_eccentricity", "encoder_quantization", "encoder_slip"), TURNS),
        **dict.fromkeys(("bandwidth", "latency", "stale_hold", "timestamp_jitter"), QUICK),
        "backlash": REVERSALS,
        **dict.fromkeys(("deadband", "quantization"), THROUGH_ZERO),
    }
)
"""Maneuver in which an effect shows best; SPEEDS for all further effects. Derived: from their equations."""


class NextRecording(NamedTuple):
    """The motion to record next.

    maneuvers, limits
        Maneuvers of the motion, which take equal parts of it, and their limits.
    """

    minutes: float
    maneuvers: tuple[Maneuver, ...]
    limits: MotionLimits

    @property
    def says(self) -> str:
        """The motion in words."""
        return " and ".join(maneuver.says(self.limits) for maneuver in self.maneuvers)

    @property
    def warming(self) -> str:
        """Words on when to warm the air, because a table does not do that; empty if no maneuver warms it."""
        starts_s = [STILL_S + index * self._part_s for index, item in enumerate(self.maneuvers) if item.warms_air]
        times = " and ".join(f"from {start_s:.0f} to {start_s + 0.5 * self._part_s:.0f} s" for start_s in starts_s)
        return f", and warm the air by {self._warmer_c:.0f} °C {times} and let it cool" if starts_s else ""

    @property
    def profile(self) -> Profile:
        """The motion as a profile."""
        segments: list[Segment] = [Rest(kind="rest", seconds=STILL_S)]
        ambient = [Ambient(at_s=0.0, temp_c=AIR_C)]
        for index, maneuver in enumerate(self.maneuvers):
            segments += maneuver.segments(self._part_s, self.limits)
            if maneuver.warms_air:
                ambient += self._warm(STILL_S + index * self._part_s)
        about = f"{self.minutes:g} min from power-on: {self.says}."
        return Profile(about=about, segments=tuple(segments), ambient=tuple(ambient))

    @property
    def profile_yaml(self) -> str:
        """Text of a file for `simulate --profile` and `firmware_sim`."""
        # JSON has plain lists. YAML would write a tuple that is used twice as an alias, which profiles must not have.
        text: str = yaml.safe_dump(self.profile.model_dump(mode="json"), sort_keys=False, width=100)
        return text

    @property
    def _part_s(self) -> float:
        """Length of a maneuver, s."""
        return (60.0 * self.minutes - STILL_S) / len(self.maneuvers)

    @property
    def _warmer_c(self) -> float:
        """Rise of the air temperature in a maneuver, °C."""
        return min(WARMER_C, WARMS_C_PER_S * 0.5 * self._part_s)

    def _warm(self, start_s: float) -> list[Ambient]:
        """Temperatures of the air that rise until the middle of a maneuver and fall until its end."""
        points = [(0.0, AIR_C), (0.5, AIR_C + self._warmer_c), (1.0, AIR_C)]
        return [Ambient(at_s=start_s + share * self._part_s, temp_c=temp_c) for share, temp_c in points]


def next_recording_of(effects: Sequence[str], minutes: float, base: Base) -> NextRecording:
    """The motion that shows these effects: each of their maneuvers once, in equal parts."""
    maneuvers = tuple(dict.fromkeys(SHOWN_BY.get(name, SPEEDS) for name in effects))
    return NextRecording(minutes, maneuvers, limits_of(base))
