"""Motions with an attitude, against integrations that share nothing with them."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import fixed_quad
from scipy.spatial.transform import Rotation

from firmware_sim.effects.effect import Floats
from firmware_sim.motion.attitude.kinematics import Kinematics
from firmware_sim.motion.attitude.profile import AttitudeProfile
from firmware_sim.motion.attitude.track import ORDER, StepTrack, Track, drawn_tones
from firmware_sim.motion.profile import Profile, config_folder, load_motion, load_profile, shipped_profiles
from firmware_sim.yaml_file import FileError

GRAVITY = 9.81
TURNS = [
    {"kind": "rest", "seconds": 4.0},
    {"kind": "ramp", "seconds": 1.0, "to_dps": 90.0},
    {"kind": "hold", "seconds": 6.0},
    {"kind": "ramp", "seconds": 1.0, "to_dps": 0.0},
]
KINDS: dict[str, dict[str, Any]] = {
    "table": {"segments": TURNS, "lean_deg": 15.0, "radius_m": 0.3},
    "ramps": {},
    "boat": {},
    "hand": {},
    "limb": {},
    "arm": {},
    "drone": {},
}
SHIPPED = sorted(path.stem for path in (config_folder() / "profiles" / "attitude").glob("*.yaml"))
START_S, SECONDS = 5.5, 6.0
"""Part of a motion that is integrated: it begins after the rest."""


def profile_of(kind: str, mount: dict[str, float] | None = None, **fields: Any) -> AttitudeProfile:
    return AttitudeProfile.model_validate(
        {"about": "Of a test.", "motion": {"kind": kind, **KINDS[kind], **fields}, "mount": mount or {}}
    )


def rotations_of(motion: Kinematics) -> Rotation:
    return Rotation.from_quat(np.roll(motion.quaternion, -1, axis=1))


def integrated(profile: AttitudeProfile, start_s: float, seconds: float) -> Rotation:
    """Attitude after some time from the rates alone: the product of steps of 2 ms.

    Each is the exponential of the Magnus expansion of fourth order, from the rates at the two points of Gauss
    (Iserles and Nørsett 1999). Its error is of the fifth order in the step.
    """
    step_s = 2e-3
    starts_s = start_s + step_s * np.arange(round(seconds / step_s))
    early, late = (
        np.deg2rad(profile.kinematics_at(starts_s + share * step_s).rates_dps)
        for share in (0.5 - np.sqrt(3.0) / 6.0, 0.5 + np.sqrt(3.0) / 6.0)
    )
    vectors = 0.5 * step_s * (early + late) + np.sqrt(3.0) / 12.0 * step_s**2 * np.cross(early, late)
    steps = Rotation.from_rotvec(vectors)
    while len(steps) > 1:  # products of neighbors; the last one of an odd number waits
        odd = steps[len(steps) // 2 * 2 :]
        pairs = steps[0 : len(steps) // 2 * 2 : 2] * steps[1 : len(steps) // 2 * 2 : 2]
        steps = Rotation.concatenate([pairs, odd]) if len(odd) else pairs
    return rotations_of(profile.kinematics_at(np.array([start_s])))[0] * steps[0]


@pytest.mark.parametrize("mount", [{}, {"roll_deg": 20.0, "pitch_deg": -30.0, "yaw_deg": 50.0}], ids=["flat", "tilted"])
@pytest.mark.parametrize("kind", KINDS)
def test_integrated_rates_give_the_attitude(kind: str, mount: dict[str, float]) -> None:
    profile = profile_of(kind, mount)
    for seconds in (1.0, SECONDS):
        truth = rotations_of(profile.kinematics_at(np.array([START_S + seconds])))[0]
        assert (integrated(profile, START_S, seconds).inv() * truth).magnitude() < 1e-6


@pytest.mark.parametrize("kind", KINDS)
def test_the_position_differentiated_twice_gives_the_specific_force(kind: str) -> None:
    """The position is the integral of the velocity; gravity is added, and the sensor turns the sum into its frame."""
    profile, step_s = profile_of(kind, {"roll_deg": 35.0}), 1e-3
    t_s = np.linspace(START_S, START_S + SECONDS, 100)

    def gained(from_s: float) -> Floats:
        moved, _ = fixed_quad(lambda x: profile.kinematics_at(x).velocity_mps.T, from_s, from_s + step_s, n=6)
        return np.asarray(moved)

    second = np.array([gained(now_s) - gained(now_s - step_s) for now_s in t_s]) / step_s**2
    motion = profile.kinematics_at(t_s)
    expected = rotations_of(motion).inv().apply(second + np.array([0.0, 0.0, GRAVITY]))
    assert np.abs(motion.specific_force_mps2(GRAVITY) - expected).max() < 2e-3
    assert np.abs(second).max() > 0.1


@pytest.mark.parametrize("name", SHIPPED)
def test_the_heading_is_the_unwrapped_twist_about_the_vertical(name: str) -> None:
    profile = load_motion(name)
    assert isinstance(profile, AttitudeProfile)
    motion = profile.kinematics_at(np.arange(0.0, 200.0, 0.01))
    twist_deg = np.degrees(2.0 * np.arctan2(motion.quaternion[:, 3], motion.quaternion[:, 0]))
    turns = (motion.heading_deg - twist_deg) / 360.0
    assert np.abs(turns - np.rint(turns)).max() < 1e-9
    assert np.abs(np.diff(motion.heading_deg)).max() < 6.0
    assert np.ptp(motion.heading_deg) > 30.0


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "table"])
def test_a_pass_begins_and_ends_at_rest(kind: str) -> None:
    """Level, for some seconds, without any rate or acceleration; between them it moves."""
    profile = profile_of(kind, minutes=1.0)
    t_s = np.arange(-1.0, 60.0, 0.01)
    motion = profile.kinematics_at(t_s)
    is_still = motion.is_still()
    assert is_still[t_s < 4.9].all()
    assert is_still[t_s > 59.0].all()
    assert not is_still[(t_s > 6.0) & (t_s < 15.0)].all()
    assert np.abs(motion.specific_force_mps2(GRAVITY)[is_still & (t_s > 59.0)] - [0.0, 0.0, GRAVITY]).max() < 1e-12


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "table"])
def test_each_pass_repeats_the_first_from_another_heading(kind: str) -> None:
    """The sensor feels the same; the heading goes on."""
    profile = profile_of(kind)
    t_s = np.arange(0.0, profile.seconds, profile.seconds / 200.0)
    first, later = profile.kinematics_at(t_s), profile.kinematics_at(t_s + 3.0 * profile.seconds)
    gained_deg = later.heading_deg - first.heading_deg
    assert np.abs(first.rates_dps - later.rates_dps).max() < 1e-6
    assert np.abs(first.specific_force_mps2(GRAVITY) - later.specific_force_mps2(GRAVITY)).max() < 1e-6
    assert np.ptp(gained_deg) < 1e-6
    yaw = Rotation.from_euler("z", gained_deg[:, None], degrees=True)
    assert (rotations_of(later).inv() * yaw * rotations_of(first)).magnitude().max() < 1e-6


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != "table"])
def test_the_seed_decides_the_motion(kind: str) -> None:
    """Equal seeds give equal motions, and unequal ones do not."""
    t_s = np.arange(0.0, 30.0, 0.1)
    motion, same, different = (profile_of(kind, seed=seed).kinematics_at(t_s).rates_dps for seed in (3, 3, 4))
    assert np.array_equal(motion, same)
    assert np.abs(motion - different).max() > 1.0


@given(st.floats(0.0, 80.0))
def test_a_tilted_sensor_on_a_level_table_reads_the_cosine(tilt_deg: float) -> None:
    """About its z axis; the heading is that of the table."""
    profile = profile_of("table", {"roll_deg": tilt_deg}, lean_deg=0.0)
    heading_deg, rate_dps = profile.motion_at(np.array([8.0, 9.0]))
    assert rate_dps == pytest.approx(90.0 * np.cos(np.radians(tilt_deg)), abs=1e-9)
    assert heading_deg[1] - heading_deg[0] == pytest.approx(90.0, abs=1e-9)


def test_a_turning_table_pulls_outward_and_gravity_moves_once_per_turn() -> None:
    flat = profile_of("table", lean_deg=0.0).kinematics_at(np.arange(7.0, 9.0, 0.1))
    pull = np.array([-(np.radians(90.0) ** 2) * 0.3, 0.0, GRAVITY])
    assert np.abs(flat.specific_force_mps2(GRAVITY) - pull).max() < 1e-9
    leaning = profile_of("table", radius_m=0.0).kinematics_at(np.arange(7.0, 11.0, 0.01))
    across = leaning.specific_force_mps2(GRAVITY)[:, :2]
    assert np.linalg.norm(across, axis=1) == pytest.approx(GRAVITY * np.sin(np.radians(15.0)), abs=1e-9)
    assert np.ptp(np.unwrap(np.arctan2(across[:, 1], across[:, 0]))) == pytest.approx(np.radians(359.1), abs=1e-3)


def test_thrust_of_a_drone_is_along_its_z_axis() -> None:
    profile = profile_of("drone", drag_per_s=0.4)
    motion = profile.kinematics_at(np.arange(10.0, 60.0, 0.05))
    drag = -0.4 * rotations_of(motion).inv().apply(motion.velocity_mps)
    assert np.abs(motion.specific_force_mps2(9.80665)[:, :2] - drag[:, :2]).max() < 1e-9
    assert np.abs(drag[:, :2]).max() > 0.1


def test_a_vehicle_keeps_to_its_largest_acceleration() -> None:
    """Along the way and sideways; at a stop it stands."""
    level: dict[str, Any] = {"slope_deg": 0.0, "bank_deg": 0.0, "sensor_m": [0.0, 0.0, 0.0]}
    motion = profile_of("ramps", None, speed_mps=15.0, accel_mps2=3.0, **level).kinematics_at(
        np.arange(0.0, 590.0, 0.02)
    )
    along = rotations_of(motion).inv().apply(motion.acceleration_mps2)
    assert 2.0 < np.abs(along).max(axis=0)[0] <= 3.0 + 1e-9
    assert 2.0 < np.abs(along).max(axis=0)[1] <= 3.0 + 1e-9
    assert 0.1 < motion.is_still().mean() < 0.6


def test_a_robot_drives_along_its_x_axis() -> None:
    """The point that follows the way has no speed across it."""
    profile = profile_of("ramps", sensor_m=[0.0, 0.0, 0.0])
    motion = profile.kinematics_at(np.arange(0.0, 100.0, 0.1))
    along = rotations_of(motion).inv().apply(motion.velocity_mps)
    assert np.abs(along[:, 1:]).max() < 1e-12
    assert along[:, 0].max() > 0.3


@given(st.integers(0, 2**32), st.lists(st.floats(-100.0, 100.0), min_size=1, max_size=5))
def test_the_derivatives_of_a_track_are_those_of_its_value(seed: int, values: list[float]) -> None:
    steps, window = StepTrack(), StepTrack()
    for number, value in enumerate(values):
        steps.move_to(value, 1.0 + 3.0 * number, 2.0)
    window.move_to(1.0, 0.5, 2.0)
    window.move_to(0.0, 4.0, 2.0)
    track = Track(steps, drawn_tones(np.random.default_rng(seed), 5.0, (0.2, 1.0)), window)
    t_s, half_s = np.linspace(0.0, 8.0, 161), 1e-5
    slopes = (track.values_at(t_s + half_s) - track.values_at(t_s - half_s)) / (2.0 * half_s)
    exact = track.values_at(t_s)
    for order in range(ORDER):
        scale = 1.0 + np.abs(exact[order + 1]).max() + np.abs(exact[ORDER]).max()
        assert np.abs(slopes[order] - exact[order + 1]).max() < 1e-4 * scale


@pytest.mark.parametrize("name", SHIPPED)
def test_a_device_with_one_axis_plays_a_shipped_attitude(name: str) -> None:
    profile = load_motion(name)
    heading_deg, rate_dps = profile.motion_at(np.arange(0.0, 100.0, 0.1))
    assert name in shipped_profiles()
    assert np.isfinite(heading_deg).all()
    assert np.abs(rate_dps).max() > 1.0
    assert profile.sensor_c_at(np.array([0.0]))[0] == 25.0


def test_a_file_without_a_motion_is_a_turntable() -> None:
    assert isinstance(load_motion("turntable"), Profile)
    assert load_motion("turntable") == load_profile("turntable")


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("motion: {kind: fly}", "motion: 'fly' is not known; there are"),
        ("motion: {minutes: 1}", "motion: 'kind' is missing"),
        ("motion: {kind: boat, period_s: 0}", "motion.period_s: is 0"),
        ("motion: {kind: boat, sensor_m: [1, 2]}", "motion.sensor_m.2: is "),
        ("motion: {kind: arm}\nsegments: []", "segments: is not known here"),
        ("motion: {kind: arm}\nmount: {roll_deg: 200}", "mount.roll_deg: is 200"),
        (
            "motion: {kind: arm}\nambient: [{at_s: 1, temp_c: 1}, {at_s: 1, temp_c: 2}]",
            "times of ambient must increase",
        ),
    ],
)
def test_mistakes_of_a_file_are_told_with_their_place(text: str, problem: str, tmp_path: Path) -> None:
    path = tmp_path / "profile.yaml"
    path.write_text(f"about: test\n{text}\n")
    with pytest.raises(FileError) as caught:
        load_motion(str(path))
    assert problem in str(caught.value)
    assert str(path) in str(caught.value)
