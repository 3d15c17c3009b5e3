"""The hard cases: a standard set of simulated sessions at which drift reducers fail.

Each case has one difficulty of real motions, sensors or surroundings, in two versions: `still` rests for the first ten
seconds, `moving` moves from its first sample on. Every session has its own motion and its own sensor, whose power-on
bias, noise and bias instability are drawn like those of real parts. Both versions of a session share them. The same
seed gives the same bytes.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from zlib import crc32

import numpy as np

from firmware_sim.effects.effect import Effect, Rng
from firmware_sim.effects.environment import TempBias, Warmup
from firmware_sim.effects.link import SampleDrop
from firmware_sim.effects.sensor_bias import BiasInstability, RateRandomWalk
from firmware_sim.effects.sensor_curve import ScaleFactor
from firmware_sim.effects.sensor_dynamics import Vibration
from firmware_sim.motion.profile import Ambient, Profile, Segment
from firmware_sim.motion.segments import Ramp, Rest
from firmware_sim.rig import Base, Rig, SimulatedAid
from gyrodrift.io.files import write_whole
from gyrodrift.simulation.hard_attitudes import ATTITUDE_CASES, AttitudeCase, attitude_simulation
from gyrodrift.simulation.hard_motions import (
    BIAS_DPS,
    FLOOR_DPH,
    NOISE_DPS_RTHZ,
    RAMP_S,
    STILL_S,
    Later,
    Motions,
    either_sign,
    slow_curves,
    spin,
    turns_with_rests,
    turns_without_rests,
)
from gyrodrift.simulation.sessions import Simulation, rig_yaml, write_simulation

SESSIONS = 10
MINUTES = 10.0

MOVES_DPS = 1.0
"""A drive counts as moving above this rate."""

Effects = Callable[[Rng], Sequence[Effect]]


@dataclass(frozen=True, slots=True)
class Case:
    """One hard case.

    about
        Its difficulty.
    motion
        Motion of the table.
    effects
        Effects of the sensor besides bias, noise and bias instability.
    bias_dps
        Absolute power-on bias with a random sign; None draws it like that of real parts.
    swing_c
        Change of the air temperature over a session, °C.
    aids
        Second sources beside the gyro.
    """

    name: str
    about: str
    motion: Motions
    effects: Effects = lambda _: ()
    bias_dps: float | None = None
    swing_c: float = 0.0
    aids: tuple[SimulatedAid, ...] = ()


CASES = (
    Case("turntable", "a turntable with rests: the usual case", turns_with_rests),
    Case("few-rests", "almost no rests", turns_without_rests),
    Case("spin-0.5", "a constant spin of 0.5 deg/s, which looks like a bias", spin(0.5)),
    Case("spin-1.5", "a constant spin of 1.5 deg/s", spin(1.5)),
    Case("spin-20", "a constant spin of 20 deg/s", spin(20.0)),
    Case("bias-3", "a bias of 3 deg/s at power-on", turns_with_rests, bias_dps=3.0),
    Case(
        "scale-1",
        "rates 1 % too large or small",
        turns_with_rests,
        lambda rng: [ScaleFactor(error_percent=either_sign(rng))],
    ),
    Case(
        "warmup",
        "a warm-up by 0.5 deg/s within minutes",
        turns_with_rests,
        lambda rng: [Warmup(amplitude_dps=0.5 * either_sign(rng), time_constant_s=60.0)],
    ),
    Case(
        "temperature",
        "air that warms by 20 °C and cools again",
        turns_with_rests,
        lambda rng: [TempBias(slope_dps_per_c=0.03 * either_sign(rng))],
        swing_c=20.0,
    ),
    Case("drive", "a drive with long, slow curves", slow_curves),
    Case(
        "random-walk",
        "a bias that walks",
        turns_with_rests,
        lambda _: [RateRandomWalk(density_dps_rts=0.005)],
    ),
    Case(
        "vibration",
        "a motor that shakes the part",
        turns_with_rests,
        lambda rng: [Vibration(amplitude_dps=0.5, frequency_hz=float(rng.uniform(10.0, 200.0)))],
    ),
    Case(
        "drops",
        "one sample in a hundred is lost",
        turns_with_rests,
        lambda _: [SampleDrop(share_percent=1.0)],
    ),
)


AIDED_CASES = (
    Case(
        "heading-a-minute",
        "no rest, and one heading a minute, late, with another zero, one in ten wrong",
        turns_without_rests,
        aids=(SimulatedAid(name="heading", every_s=60.0, late_s=1.0, offset_deg=40.0, wrong_share=0.1),),
    ),
    Case(
        "slipping-wheels",
        "wheels with a wrong track that slip, and a speed that reads 0 below a threshold",
        turns_with_rests,
        aids=(
            SimulatedAid(name="wheels", every_s=0.1, scale_percent=2.0, slip_share=0.2),
            SimulatedAid(name="speed", every_s=0.2, threshold=0.1),
        ),
    ),
    Case(
        "walls",
        "directions of a building, coarse, and gone half of the time",
        turns_without_rests,
        aids=(SimulatedAid(name="heading", every_s=5.0, sigma=3.0, period_deg=90.0, gone_share=0.5, resolution=1.0),),
    ),
)
"""Cases with a second source and its flaws; the gyro alone fails at most of them."""


def write_hard_cases(
    folder: Path,
    seed: int,
    sessions: int = SESSIONS,
    minutes: float = MINUTES,
    ending: str = "mcap",
    axes: int = 1,
    *,
    is_aided: bool = False,
) -> Iterator[Path]:
    """Write `folder/CASE-still/session-01` and so on, each with its rig, and yield the path of each written session.

    Raises
    ------
    UsageError
        A file cannot be written.
    """
    for case, is_still in _versions(axes, is_aided=is_aided):
        for number in range(sessions):
            path = _path(folder, case.name, number, ending, is_still=is_still)
            _write(path, _simulated(case, seed, number, minutes, is_still=is_still))
            yield path


def hard_case_paths(
    folder: Path, sessions: int = SESSIONS, ending: str = "mcap", axes: int = 1, *, is_aided: bool = False
) -> list[Path]:
    """Paths of the sessions of `write_hard_cases`."""
    return [
        _path(folder, case.name, number, ending, is_still=is_still)
        for case, is_still in _versions(axes, is_aided=is_aided)
        for number in range(sessions)
    ]


def hard_case_count(sessions: int = SESSIONS, axes: int = 1, *, is_aided: bool = False) -> int:
    """Number of sessions of `write_hard_cases`."""
    return len(_versions(axes, is_aided=is_aided)) * sessions


def _versions(axes: int, *, is_aided: bool) -> list[tuple[Case | AttitudeCase, bool]]:
    cases: Sequence[Case | AttitudeCase] = AIDED_CASES if is_aided else CASES if axes == 1 else ATTITUDE_CASES
    return [(case, is_still) for case in cases for is_still in (True, False)]


def _path(folder: Path, case: str, number: int, ending: str, *, is_still: bool) -> Path:
    return folder / f"{case}-{'still' if is_still else 'moving'}" / f"session-{number + 1:02d}.{ending}"


def _write(path: Path, simulated: Simulation) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path.with_suffix(".rig.yaml"), [rig_yaml(simulated.rig)])
    write_simulation(path, simulated, f"{path.parent.name}-{simulated.number + 1:02d}")


def _simulated(case: Case | AttitudeCase, seed: int, number: int, minutes: float, *, is_still: bool) -> Simulation:
    if isinstance(case, AttitudeCase):
        return attitude_simulation(case, seed, number, minutes, is_still=is_still)
    return simulation(case, seed, number, minutes, is_still=is_still)


def simulation(case: Case, seed: int, number: int, minutes: float = MINUTES, *, is_still: bool) -> Simulation:
    """One session of a case; its random numbers are the same in both versions."""
    rng = np.random.default_rng([seed, crc32(case.name.encode()), number])
    rig, seconds = _part(case, rng), 60.0 * minutes
    body = case.motion(rng, seconds)
    lead: tuple[Segment, ...] = (Rest(kind="rest", seconds=STILL_S),) if is_still else ()
    profile = Profile(about=case.about, segments=(*lead, *body), ambient=_ambient(case.swing_c, seconds))
    motion = profile if is_still else Later(profile, _under_way_s(profile))
    return Simulation(rig, motion, int(rng.integers(2**31)), number, minutes)


def _part(case: Case, rng: Rng) -> Rig:
    """A low-cost gyro."""
    drawn_dps = BIAS_DPS * float(rng.standard_normal())
    bias_dps = drawn_dps if case.bias_dps is None else case.bias_dps * float(np.copysign(1.0, drawn_dps))
    noise, floor = (float(np.exp(rng.uniform(*np.log(ends)))) for ends in (NOISE_DPS_RTHZ, FLOOR_DPH))
    return Rig(
        base=Base(bias_dps=bias_dps, noise_dps_rthz=noise),
        effects=(BiasInstability(floor_dph=floor), *case.effects(rng)),
        aids=case.aids,
    )


def _ambient(swing_c: float, seconds: float) -> tuple[Ambient, ...]:
    """Air temperature: 25 °C, up by the swing, down to half the swing below, and back."""
    points = [(0.0, 0.0), (0.4, swing_c), (0.8, -0.5 * swing_c), (1.0, 0.0)]
    return tuple(Ambient(at_s=share * seconds, temp_c=25.0 + above_c) for share, above_c in points)


def _under_way_s(profile: Profile) -> float:
    """Time at which the motion has started, s: the end of a ramp, or the first movement of a drive."""
    if isinstance(profile.segments[0], Ramp):
        return RAMP_S
    t_s = np.arange(0.0, profile.seconds, 0.1)
    return float(t_s[np.argmax(np.abs(profile.motion_at(t_s)[1]) > MOVES_DPS)])
