"""The hard cases of three axes: both versions of each, with what makes them hard, and different parts."""

from pathlib import Path

import numpy as np
import pytest

from firmware_sim.effects.effect import Floats
from firmware_sim.effects.triaxial.vibration import MotorVibration
from firmware_sim.rig import load_rig
from firmware_sim.triaxial import kinematics_of
from gyrodrift.cli import main
from gyrodrift.session.files import load_session
from gyrodrift.simulation.hard_attitudes import ATTITUDE_CASES, AttitudeCase, attitude_simulation

BY_NAME = {case.name: case for case in ATTITUDE_CASES}


def tilt_deg(case: AttitudeCase, seconds: float = 120.0) -> Floats:
    """Tilt of the sensor in the moving version."""
    simulated = attitude_simulation(case, 1, 0, 3.0, is_still=False)
    _, x, y, _ = kinematics_of(simulated.profile, np.arange(0.0, seconds, 0.1)).quaternion.T
    tilts_deg: Floats = np.degrees(np.arccos(1.0 - 2.0 * (x**2 + y**2)))
    return tilts_deg


@pytest.mark.parametrize("case", ATTITUDE_CASES, ids=lambda case: case.name)
def test_a_case_comes_at_rest_and_moving(case: AttitudeCase) -> None:
    """Ten seconds (a limb 0.4), or not one sample; the heading starts at 0."""
    for number in range(3):
        still, moving = (attitude_simulation(case, 4, number, 1.0, is_still=is_still) for is_still in (True, False))
        t_s = np.arange(0.0, case.still_s - 0.05, 0.1)
        assert kinematics_of(still.profile, t_s).is_still().all()
        assert not kinematics_of(still.profile, np.arange(case.still_s + 2.0, 20.0, 0.1)).is_still().all()
        motion = kinematics_of(moving.profile, np.arange(0.0, 1.0, 0.1))
        assert not motion.is_still().any()
        assert motion.heading_deg[0] == pytest.approx(0.0, abs=1e-9)
        assert still.rig == moving.rig


@pytest.mark.parametrize(
    ("name", "least_deg", "most_deg"),
    [
        ("tilted", 19.9, 20.1),
        ("leaning", 14.9, 15.1),
        ("even-turn-2", -0.1, 0.1),
        ("ramps", 14.0, 17.0),
        ("car", -0.1, 0.1),
        ("limb", 30.0, 100.0),
        ("heel", 15.0, 45.0),
        ("hand", 50.0, 150.0),
        ("hand-fast", 50.0, 150.0),
        ("arm", 50.0, 150.0),
        ("drone", 15.0, 60.0),
    ],
)
def test_motions_tilt_as_far_as_their_names_say(name: str, least_deg: float, most_deg: float) -> None:
    assert least_deg < tilt_deg(BY_NAME[name]).max() < most_deg


@pytest.mark.parametrize("rate_dps", [2.0, 8.0])
def test_an_even_turn_is_even(rate_dps: float) -> None:
    """About the vertical, from the first sample on."""
    simulated = attitude_simulation(BY_NAME[f"even-turn-{rate_dps:g}"], 1, 0, 1.0, is_still=False)
    motion = kinematics_of(simulated.profile, np.arange(0.0, 50.0, 0.1))
    assert np.abs(np.abs(motion.rates_dps) - [0.0, 0.0, rate_dps]).max() < 1e-9


def test_parts_differ() -> None:
    bases = [attitude_simulation(case, 1, n, 1.0, is_still=True).rig.base for case in ATTITUDE_CASES for n in range(2)]
    assert len({base.noise_dps_rthz for base in bases}) == len(bases)
    assert len({base.three_axes.effects for base in bases if base.three_axes is not None}) == len(bases)
    biases = np.array([[b.bias_dps, b.three_axes.gyro_bias_x_dps] for b in bases if b.three_axes is not None])
    assert 0.3 < biases.std() < 0.7


def test_an_accelerometer_goes_silent() -> None:
    session = attitude_simulation(BY_NAME["accel-loss"], 1, 0, 2.5, is_still=True).whole()
    assert session.accel_mps2 is not None
    assert session.gyro_dps is not None
    assert np.flatnonzero(np.isnan(session.accel_mps2[:, 0]))[0] == 12000
    assert np.isfinite(session.gyro_dps).all()


def test_the_set_is_written_with_rigs_and_truth(tmp_path: Path) -> None:
    """Sessions of a seed have the same bytes."""
    options = ["--hard-cases", "--axes", "3", "--sessions", "1", "--minutes", "0.2", "--seed", "4"]
    for folder in ("a", "b"):
        assert main(["simulate", "--out", str(tmp_path / folder), *options]) == 0
    written = sorted(path.relative_to(tmp_path / "a") for path in (tmp_path / "a").rglob("*.*"))
    assert len(written) == 2 * len(ATTITUDE_CASES) * 3
    for path in written:
        assert (tmp_path / "a" / path).read_bytes() == (tmp_path / "b" / path).read_bytes()
    session = load_session(tmp_path / "a" / "hand-still" / "session-01.mcap")
    assert session.gyro_dps is not None
    assert load_rig(tmp_path / "a" / "hand-still" / "session-01.rig.yaml").base.three_axes is not None


def test_motors_do_not_alias_to_slow_motion() -> None:
    """A real chip has a low-pass against this."""
    for number in range(40):
        effects = attitude_simulation(BY_NAME["drone"], 1, number, 1.0, is_still=True).rig.base.three_axes
        assert effects is not None
        (motor,) = (effect for effect in effects.effects if isinstance(effect, MotorVibration))
        assert 60.0 <= motor.frequency_hz <= 250.0
        assert min(abs(motor.frequency_hz - 100.0 * k) for k in range(4)) > 15.0
