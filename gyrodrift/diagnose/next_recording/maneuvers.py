"""Maneuvers that a next recording is made of. Each separates causes that the remaining maneuvers do not separate."""

from collections.abc import Callable
from dataclasses import dataclass
from math import floor, pi

from firmware_sim.measure import COUNTS_MAX
from firmware_sim.motion.profile import Segment
from firmware_sim.motion.segments import Drive, Ramp, Rest, Steps
from firmware_sim.motion.waves import Chirp, Multisine
from firmware_sim.rig import Base

SHARE_OF_RANGE, FASTEST_DPS = 0.9, 300.0
"""Share of the range of the gyro that a motion uses, and the highest rate of a small turntable. Chosen: a tenth of the
range is left for bias and overshoot."""

WAVE_DPS = 40.0
"""Amplitude of chirps; √2 times the RMS of multisines. Chosen: a table with a load follows it to 12 Hz."""

SLOWEST_HZ = 0.2
"""Lowest frequency of chirps and multisines. Chosen: as in `config/profiles/identify.yaml`."""


@dataclass(frozen=True, slots=True)
class MotionLimits:
    """Highest rate in deg/s, and the frequency up to which chirps and multisines run, Hz."""

    rate_dps: float
    wave_hz: float

    @property
    def wave_dps(self) -> float:
        """Amplitude of chirps, deg/s; √2 times the RMS of multisines."""
        return min(WAVE_DPS, self.rate_dps)


def limits_of(base: Base) -> MotionLimits:
    """Limits for the gyro and the encoder of a rig."""
    rate_dps = min(SHARE_OF_RANGE * COUNTS_MAX * base.dps_per_lsb, FASTEST_DPS)
    swing_deg = 4.0 * 360.0 / max(1, base.encoder_cpr)
    # Four counts from end to end are visible. A rate of amplitude a swings the angle by 2a / (2 pi f).
    resolvable_hz = min(WAVE_DPS, rate_dps) / (pi * swing_deg)
    # Half of the Nyquist frequency, and the highest frequency that a table with a load follows.
    wave_hz = min(resolvable_hz, 0.25 * base.sample_rate_hz, 12.0)
    return MotionLimits(rate_dps, max(wave_hz, 2.0 * SLOWEST_HZ))


Segments = list[Segment]

RAMP_S, SHARP_S = 0.5, 0.1
"""Duration of a change of rate, and of a sharp change. Chosen: as in `config/profiles/identify.yaml`."""

HOLD_S = 8.0
"""Approximate duration of a constant rate; between reversals it is much shorter. Chosen: several blocks of a second at
each rate."""

THROUGH_ZERO_DPS = 3.0
CREEP_S = 2.0
"""A slow ramp runs between -THROUGH_ZERO_DPS and THROUGH_ZERO_DPS. Before and after it the rate changes for CREEP_S.
Chosen: as in `config/profiles/identify.yaml`."""

CURVE_S, DRIVE_DPS, STANDS = 4.0, 20.0, 0.1
"""Duration of a curve of a drive, RMS of its rate, and its share of rest. Chosen: several curves fit into a
maneuver."""


@dataclass(frozen=True, slots=True)
class Maneuver:
    """A motion of any length.

    name
        Identifier.
    says
        Description in a few words for a person, from the limits.
    segments
        Segments of the motion from its length in s and the limits. It begins and ends at rest.
    warms_air
        Whether the air warms during the motion and cools again.
    """

    name: str
    says: Callable[[MotionLimits], str]
    segments: Callable[[float, MotionLimits], Segments]
    warms_air: bool = False


def _rest(seconds: float, _: MotionLimits) -> Segments:
    return [Rest(kind="rest", seconds=seconds)]


def _steps(seconds: float, rates_dps: tuple[float, ...], ramp_s: float, hold_s: float) -> Segments:
    """Rates with both signs, in as many rounds as fit if each rate lasts about `hold_s`; exactly `seconds` long."""
    signed_dps = tuple(signed for rate_dps in rates_dps for signed in (rate_dps, -rate_dps))
    rounds = max(1, round(seconds / (len(signed_dps) * (ramp_s + hold_s))))
    rates = signed_dps * rounds
    exact_hold_s = (seconds - ramp_s) / len(rates) - ramp_s
    return [Steps(kind="steps", rates_dps=rates, ramp_seconds=ramp_s, hold_seconds=exact_hold_s)]


def _turns(seconds: float, rate_dps: float) -> Segments:
    """Whole turns in one direction, the same number back, and rest for the remaining time."""
    turn_s = 360.0 / rate_dps
    turns = max(1, floor((seconds - 2.0 * RAMP_S) / (2.0 * turn_s)))
    hold_s = turns * turn_s - RAMP_S
    segments: Segments = []
    for signed_dps in (rate_dps, -rate_dps):
        segments.append(Steps(kind="steps", rates_dps=(signed_dps,), ramp_seconds=RAMP_S, hold_seconds=hold_s))
    remaining_s = seconds - sum(segment.seconds for segment in segments)
    return [*segments, Rest(kind="rest", seconds=remaining_s)] if remaining_s > 0.0 else segments


def _chirp(seconds: float, limits: MotionLimits) -> Segments:
    return [
        Chirp(kind="chirp", seconds=seconds, amplitude_dps=limits.wave_dps, from_hz=SLOWEST_HZ, to_hz=limits.wave_hz)
    ]


def _multisine(seconds: float, limits: MotionLimits) -> Segments:
    rms_dps = limits.wave_dps / 2.0**0.5
    return [
        Multisine(
            kind="multisine", seconds=seconds, rms_dps=rms_dps, from_hz=SLOWEST_HZ, to_hz=limits.wave_hz, tones=24
        )
    ]


def _through_zero(seconds: float, _: MotionLimits) -> Segments:
    rates_dps = (-THROUGH_ZERO_DPS, THROUGH_ZERO_DPS, 0.0)
    times_s = (CREEP_S, seconds - 2.0 * CREEP_S, CREEP_S)
    return [
        Ramp(kind="ramp", seconds=time_s, to_dps=rate_dps) for time_s, rate_dps in zip(times_s, rates_dps, strict=True)
    ]


def _drive(seconds: float, _: MotionLimits) -> Segments:
    drive = Drive(
        kind="drive",
        minutes=(seconds - CURVE_S) / 60.0,
        rms_dps=DRIVE_DPS,
        curve_seconds=CURVE_S,
        rest_share=STANDS,
        seed=1,
    )
    remaining_s = seconds - drive.seconds
    return [drive, Rest(kind="rest", seconds=remaining_s)] if remaining_s > 0.0 else [drive]


def _shares(limits: MotionLimits, *shares: float) -> tuple[float, ...]:
    """Rates that are shares of the highest rate, deg/s."""
    return tuple(share * limits.rate_dps for share in shares)


def _many_speeds(seconds: float, limits: MotionLimits) -> Segments:
    return _steps(seconds, _shares(limits, 0.05, 0.2, 0.5, 0.95), RAMP_S, HOLD_S)


FAMILY = (
    Maneuver("rest", lambda _: "rest", _rest),
    Maneuver("warm_rest", lambda _: "rest in air that warms and cools", _rest, warms_air=True),
    Maneuver(
        "warm_steps",
        lambda limits: f"steps of both signs up to {0.95 * limits.rate_dps:.0f} deg/s in air that warms and cools",
        _many_speeds,
        warms_air=True,
    ),
    Maneuver(
        "slow_steps",
        lambda _: "steps of both signs from 2 to 20 deg/s",
        lambda seconds, _: _steps(seconds, (2.0, 6.0, 20.0), RAMP_S, HOLD_S),
    ),
    Maneuver(
        "many_speeds",
        lambda limits: f"steps of both signs at four speeds up to {0.95 * limits.rate_dps:.0f} deg/s",
        _many_speeds,
    ),
    Maneuver(
        "fast_steps",
        lambda limits: f"fast steps of both signs to {limits.rate_dps:.0f} deg/s",
        lambda seconds, limits: _steps(seconds, _shares(limits, 0.6, 1.0), RAMP_S, HOLD_S),
    ),
    Maneuver("slow_turns", lambda _: "whole turns both ways at 36 deg/s", lambda seconds, _: _turns(seconds, 36.0)),
    Maneuver(
        "fast_turns",
        lambda limits: f"whole turns both ways at {0.7 * limits.rate_dps:.0f} deg/s",
        lambda seconds, limits: _turns(seconds, 0.7 * limits.rate_dps),
    ),
    Maneuver(
        "reversals",
        lambda limits: f"sharp reversals at {0.3 * limits.rate_dps:.0f} deg/s",
        lambda seconds, limits: _steps(seconds, _shares(limits, 0.3), SHARP_S, 1.0),
    ),
    Maneuver(
        "small_reversals",
        lambda _: "sharp reversals at 8 deg/s",
        lambda seconds, _: _steps(seconds, (8.0,), SHARP_S, 1.0),
    ),
    Maneuver("chirp", lambda limits: f"a chirp to {limits.wave_hz:.3g} Hz", _chirp),
    Maneuver("multisine", lambda limits: f"a multisine to {limits.wave_hz:.3g} Hz", _multisine),
    Maneuver("through_zero", lambda _: "a slow ramp through zero", _through_zero),
    Maneuver("drive", lambda _: "gentle curves as of a drive", _drive),
)
"""All maneuvers, from which a pair is chosen."""
