"""Motions of the family: their lengths, their limits, and the file that they are played from."""

from pathlib import Path

import numpy as np
import pytest

from firmware_sim.motion.profile import load_profile
from firmware_sim.rig import Base
from gyrodrift.cli import main
from gyrodrift.diagnose.next_recording.maneuvers import FAMILY, Maneuver, MotionLimits, limits_of
from gyrodrift.diagnose.next_recording.profiles import profile_of, profile_yaml, warmer_c

LIMITS = limits_of(Base())
NAMED = {item.name: item for item in FAMILY}

families = pytest.mark.parametrize("maneuver", FAMILY, ids=[item.name for item in FAMILY])


def test_limits_are_those_of_gyro_encoder_and_table() -> None:
    """Nine tenths of the range; a swing of 40 deg/s takes four counts; a quarter of the sample rate; 12 Hz."""
    assert limits_of(Base(dps_per_lsb=0.00763)).rate_dps == pytest.approx(0.9 * 32767 * 0.00763)
    assert limits_of(Base(dps_per_lsb=0.061)).rate_dps == 300.0
    assert limits_of(Base(encoder_cpr=4096)).wave_hz == 12.0
    # 512 counts are 0.703 deg each, four of them 2.8125: 2 * 40 / (2 pi f) = 2.8125 at 4.527 Hz.
    assert limits_of(Base(encoder_cpr=512)).wave_hz == pytest.approx(4.527, abs=1e-3)
    assert limits_of(Base(sample_rate_hz=20.0)).wave_hz == 5.0


@families
@pytest.mark.parametrize("minutes", [1.0, 3.0, 10.0])
def test_a_maneuver_fills_its_time_from_rest_to_rest(maneuver: Maneuver, minutes: float) -> None:
    profile = profile_of((maneuver,), minutes, LIMITS)
    assert profile.seconds == pytest.approx(60.0 * minutes, abs=1e-6)
    t_s = np.arange(0.0, profile.seconds, 0.01)
    rate_dps = profile.motion_at(t_s)[1]
    assert abs(rate_dps[0]) < 1e-9
    assert profile.motion_at(np.array([profile.seconds - 1e-6]))[1] == pytest.approx(0.0, abs=0.01)
    is_random = maneuver.name in {"drive", "multisine"}
    assert np.abs(rate_dps).max() <= (4.0 * 40.0 if is_random else LIMITS.rate_dps + 1e-9)


@pytest.mark.parametrize("name", ["slow_turns", "fast_turns"])
def test_turns_are_whole(name: str) -> None:
    """The angle comes back, after a multiple of 360 degrees."""
    profile = profile_of((NAMED[name],), 2.0, LIMITS)
    angle_deg = profile.motion_at(np.arange(0.0, profile.seconds, 0.01))[0]
    turns = angle_deg.max() / 360.0
    assert turns == pytest.approx(round(turns), abs=1e-3)
    assert turns >= 1.0
    assert angle_deg[-1] == pytest.approx(0.0, abs=1e-6)


def test_air_warms_in_its_own_part_alone() -> None:
    profile = profile_of((NAMED["reversals"], NAMED["warm_rest"]), 3.0, LIMITS)
    assert warmer_c(87.5) == pytest.approx(43.75 / 6.0)
    air_c = profile.ambient_at(np.array([0.0, 92.0, 92.5 + 43.75, 179.9]))
    assert air_c == pytest.approx([25.0, 25.0, 25.0 + 43.75 / 6.0, 25.0])


def test_two_warm_parts_follow_each_other() -> None:
    """The times of the air still rise."""
    profile = profile_of((NAMED["warm_rest"], NAMED["warm_steps"]), 2.0, LIMITS)
    assert profile.ambient_at(np.array([119.99])) == pytest.approx([25.0])


def test_what_is_too_short_is_refused() -> None:
    """Below a minute nothing slow shows."""
    with pytest.raises(ValueError, match="too short"):
        profile_of(FAMILY[:1], 0.5, LIMITS)


@families
def test_the_file_is_the_profile(maneuver: Maneuver, tmp_path: Path) -> None:
    profile = profile_of((maneuver, NAMED["warm_rest"]), 3.0, MotionLimits(rate_dps=137.0 / 3.0, wave_hz=7.3))
    path = tmp_path / "next-profile.yaml"
    path.write_text(profile_yaml(profile))
    assert load_profile(str(path)) == profile


def test_simulate_takes_the_file(tmp_path: Path) -> None:
    """A profile is played by the command line as it was written."""
    path = tmp_path / "next-profile.yaml"
    path.write_text(profile_yaml(profile_of((NAMED["chirp"], NAMED["drive"]), 1.0, LIMITS)))
    assert main(["simulate", "--out", str(tmp_path / "sessions"), "--profile", str(path), "--minutes", "1"]) == 0
    assert (tmp_path / "sessions" / "session-01.mcap").is_file()
