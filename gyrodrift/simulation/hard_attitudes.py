"""The hard cases of three axes: motions that tilt, shake or accelerate, and sensors with errors of all axes.

Each session has its own motion, gyro and accelerometer. Both versions of a session share them.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from zlib import crc32

import numpy as np

from firmware_sim.effects.effect import Floats, Rng
from firmware_sim.effects.sensor_bias import BiasInstability
from firmware_sim.effects.triaxial.accelerometer import AccelBias, AccelDropout
from firmware_sim.effects.triaxial.effect import TriaxialEffect
from firmware_sim.effects.triaxial.matrices import (
    AccelCrossAxis,
    AccelScale,
    GyroCrossAxis,
    GyroGSensitivity,
    GyroMisalignment,
    GyroScale,
)
from firmware_sim.effects.triaxial.vibration import MotorVibration
from firmware_sim.motion.attitude.generated import REST_S
from firmware_sim.motion.attitude.profile import AttitudeProfile
from firmware_sim.rig import Base, Rig, ThreeAxes
from gyrodrift.simulation.hard_motions import (
    BIAS_DPS,
    FLOOR_DPH,
    NOISE_DPS_RTHZ,
    STILL_S,
    LaterInSpace,
    Motions,
    spin,
    turns_with_rests,
)
from gyrodrift.simulation.sessions import Simulation

UNDER_WAY_S, MOVES_S, SEARCHED_S = 1.0, 2.5, 300.0
"""A moving version begins this time into the first movement that is so long, s; every motion has one by then."""

ERRORS: tuple[tuple[type[TriaxialEffect], float], ...] = (
    (GyroGSensitivity, 0.05),
    (GyroMisalignment, 0.5),
    (GyroCrossAxis, 0.7),
    (GyroScale, 1.0),
    (AccelCrossAxis, 0.7),
    (AccelScale, 1.0),
    (AccelBias, 0.25),
)
"""Errors of every part, with the standard deviation of their parameters.

They are half to a third of the limits of an MPU-6050 (PS-MPU-6000A 3.4, chapter 6); misalignment is that of soldering.
"""

ACCEL_NOISE = (0.001, 0.004)
"""Range of the noise of low-cost accelerometers, m/s²/√Hz: 100 to 400 µg/√Hz."""

SAMPLE_RATE_HZ = 100.0
MOTOR_HZ, SLOWEST_ALIAS_HZ = (60.0, 250.0), 15.0
"""Band of motors of small vehicles and multirotors, and their slowest alias, Hz: three times their wander."""

RANGE_DPS, RANGE_MPS2 = 2000.0, 78.5
"""Ranges of gyro and accelerometer (8 g)."""

SHORTEST_MINUTES = 3.0
"""Shortest pass of a motion; a shorter session is a part of it."""

Shape = Callable[[Rng, float], dict[str, object]]
"""Gives the block `motion` of a profile of some minutes."""

Triaxial = Callable[[Rng], Sequence[TriaxialEffect]]


@dataclass(frozen=True, slots=True)
class AttitudeCase:
    """One hard case of three axes.

    about
        Its difficulty.
    shape
        Motion in space.
    effects
        Effects besides those of every part.
    tilt_deg
        Tilt of the sensor on its device.
    still_s
        Rest at the beginning of the version `still`, s.
    """

    name: str
    about: str
    shape: Shape
    effects: Triaxial = lambda _: ()
    tilt_deg: float = 0.0
    still_s: float = STILL_S


def _generated(kind: str, **fields: object) -> Shape:
    def shape(rng: Rng, minutes: float) -> dict[str, object]:
        return {"kind": kind, "minutes": max(SHORTEST_MINUTES, minutes), "seed": int(rng.integers(2**31)), **fields}

    return shape


def _motor_hz(rng: Rng) -> float:
    """Frequency of a motor whose alias is faster than the motion: a chip filters the others away before sampling."""
    while True:
        frequency_hz = float(rng.uniform(*MOTOR_HZ))
        if abs(frequency_hz - SAMPLE_RATE_HZ * round(frequency_hz / SAMPLE_RATE_HZ)) > SLOWEST_ALIAS_HZ:
            return frequency_hz


def _car(stop_share: float) -> Shape:
    return _generated(
        "ramps",
        speed_mps=15.0,
        accel_mps2=3.0,
        slope_deg=0.0,
        bank_deg=0.0,
        stop_share=stop_share,
        sensor_m=[1.0, 0.0, 0.5],
    )


def _table(motion: Motions, **fields: object) -> Shape:
    def shape(rng: Rng, minutes: float) -> dict[str, object]:
        rest = {"kind": "rest", "seconds": REST_S}
        segments = [segment.model_dump() for segment in motion(rng, 60.0 * minutes)]
        return {"kind": "table", "segments": [rest, *segments], **fields}

    return shape


def _motors(gyro_dps: float, accel_mps2: float, rest_share: float) -> Triaxial:
    def effects(rng: Rng) -> Sequence[TriaxialEffect]:
        frequency_hz = _motor_hz(rng)
        return [
            MotorVibration(gyro_dps=gyro_dps, accel_mps2=accel_mps2, frequency_hz=frequency_hz, rest_share=rest_share)
        ]

    return effects


ATTITUDE_CASES = (
    AttitudeCase("tilted", "a turntable with a sensor tilted by 20 degrees", _table(turns_with_rests), tilt_deg=20.0),
    AttitudeCase("leaning", "a turntable whose axis leans by 15 degrees", _table(turns_with_rests, lean_deg=15.0)),
    AttitudeCase("even-turn-2", "an even turn of 2 deg/s, which looks like a bias", _table(spin(2.0), radius_m=0.2)),
    AttitudeCase("even-turn-8", "an even turn of 8 deg/s", _table(spin(8.0), radius_m=0.2)),
    AttitudeCase("ramps", "a robot on ramps of 15 degrees", _generated("ramps")),
    AttitudeCase("car", "a level car with stops, whose bends pull sideways", _car(0.3), _motors(0.1, 0.3, 0.5)),
    AttitudeCase("car-no-stops", "a level car that never stops", _car(0.0), _motors(0.1, 0.3, 0.5)),
    AttitudeCase("heel", "a boat that rolls in waves and heels in turns", _generated("boat")),
    AttitudeCase("hand", "a sensor in a slow hand", _generated("hand", fastest_hz=1.0)),
    AttitudeCase("hand-fast", "a sensor in a fast hand", _generated("hand", swing_deg=25.0, fastest_hz=3.0)),
    AttitudeCase("limb", "a swinging limb, at rest for 0.4 seconds at power-on", _generated("limb"), still_s=0.4),
    AttitudeCase("arm", "a robot arm that stops in each pose", _generated("arm")),
    AttitudeCase("drone", "a quadrotor whose motors shake the part", _generated("drone"), _motors(3.0, 3.0, 0.3)),
    AttitudeCase(
        "vibration", "ramps with a motor that always shakes the part", _generated("ramps"), _motors(1.0, 1.0, 1.0)
    ),
    AttitudeCase(
        "accel-loss",
        "a hand, with an accelerometer that goes silent after two minutes",
        _generated("hand"),
        lambda _: [AccelDropout(from_s=120.0)],
    ),
)


def attitude_simulation(case: AttitudeCase, seed: int, number: int, minutes: float, *, is_still: bool) -> Simulation:
    """One session of a case; its random numbers are the same in both versions."""
    rng = np.random.default_rng([seed, crc32(case.name.encode()), number])
    rig = _part(case, rng)
    profile = AttitudeProfile.model_validate(
        {"about": case.about, "motion": case.shape(rng, minutes), "mount": {"roll_deg": case.tilt_deg}}
    )
    start_s = REST_S - case.still_s if is_still else _under_way_s(profile)
    return Simulation(rig, LaterInSpace(profile, start_s), int(rng.integers(2**31)), number, minutes)


def _part(case: AttitudeCase, rng: Rng) -> Rig:
    """A low-cost chip with the errors of its axes."""
    x_dps, y_dps, z_dps = (BIAS_DPS * float(value) for value in rng.standard_normal(3))
    axes = ThreeAxes(
        gyro_bias_x_dps=x_dps,
        gyro_bias_y_dps=y_dps,
        mps2_per_lsb=RANGE_MPS2 / 2**15,
        accel_noise_mps2_rthz=_within(rng, ACCEL_NOISE),
        effects=(*(_drawn(rng, kind, sigma) for kind, sigma in ERRORS), *case.effects(rng)),
    )
    noise, floor = _within(rng, NOISE_DPS_RTHZ), _within(rng, FLOOR_DPH)
    base = Base(
        sample_rate_hz=SAMPLE_RATE_HZ,
        bias_dps=z_dps,
        dps_per_lsb=RANGE_DPS / 2**15,
        noise_dps_rthz=noise,
        three_axes=axes,
    )
    return Rig(base=base, effects=(BiasInstability(floor_dph=floor),))


def _drawn(rng: Rng, kind: type[TriaxialEffect], sigma: float) -> TriaxialEffect:
    """Effect whose parameters are normal with a standard deviation."""
    names = [name for name in kind.model_fields if name not in {"name", "across_dps_per_g"}]
    return kind.model_validate({name: sigma * float(rng.standard_normal()) for name in names})


def _within(rng: Rng, ends: tuple[float, float]) -> float:
    """Log-uniform number."""
    return float(np.exp(rng.uniform(*np.log(ends))))


def _under_way_s(profile: AttitudeProfile) -> float:
    """Time within the first movement of MOVES_S, s."""
    step_s = 0.1
    t_s: Floats = np.arange(0.0, min(SEARCHED_S, profile.seconds), step_s)
    moved = np.cumsum(~profile.kinematics_at(t_s).is_still())
    count = round(MOVES_S / step_s)
    begins = np.flatnonzero(moved[count:] - moved[:-count] == count)
    return float(t_s[begins[0] + 1] + UNDER_WAY_S)
