"""Motions to record next: their lengths, their limits, and the file that they are played from."""

from pathlib import Path

import numpy as np
import pytest

from firmware_sim.effects.catalogue import CATALOGUE
from firmware_sim.motion.profile import load_profile
from firmware_sim.rig import Base
from gyrodrift.cli import main
from gyrodrift.diagnose.next_recording import QUICK, SHOWN_BY, SPEEDS, limits_of, next_recording_of

BY_MANEUVER = {maneuver: name for name, maneuver in SHOWN_BY.items()} | {SPEEDS: "scale_factor"}


def test_limits_are_those_of_gyro_encoder_and_table() -> None:
    """Nine tenths of the range; a swing of 40 deg/s takes four counts; a quarter of the sample rate; 12 Hz."""
    assert limits_of(Base(dps_per_lsb=0.00763)).rate_dps == pytest.approx(0.9 * 32767 * 0.00763)
    assert limits_of(Base(dps_per_lsb=0.061)).rate_dps == 300.0
    assert limits_of(Base(encoder_cpr=4096)).wave_hz == 12.0
    # 512 counts are 0.703 deg each, four of them 2.8125: 2 * 40 / (2 pi f) = 2.8125 at 4.527 Hz.
    assert limits_of(Base(encoder_cpr=512)).wave_hz == pytest.approx(4.527, abs=1e-3)
    assert limits_of(Base(sample_rate_hz=20.0)).wave_hz == 5.0


def test_the_table_names_effects_of_the_catalogue() -> None:
    assert SHOWN_BY.keys() < CATALOGUE.keys()


@pytest.mark.parametrize("name", BY_MANEUVER.values())
@pytest.mark.parametrize("minutes", [1.0, 4.0])
def test_a_maneuver_fills_its_time_from_rest_to_rest(name: str, minutes: float) -> None:
    recording = next_recording_of([name], minutes, Base())
    profile = recording.profile
    assert profile.seconds == pytest.approx(60.0 * minutes, abs=1e-6)
    rate_dps = profile.motion_at(np.arange(0.0, profile.seconds, 0.01))[1]
    assert abs(rate_dps[0]) < 1e-9
    assert profile.motion_at(np.array([profile.seconds - 1e-6]))[1] == pytest.approx(0.0, abs=0.01)
    assert np.abs(rate_dps).max() <= (4.0 * 40.0 if QUICK in recording.maneuvers else recording.limits.rate_dps + 1e-9)


def test_turns_are_whole() -> None:
    """The angle comes back, after a multiple of 360 degrees."""
    profile = next_recording_of(["g_sensitivity"], 2.0, Base()).profile
    angle_deg = profile.motion_at(np.arange(0.0, profile.seconds, 0.01))[0]
    turns = angle_deg.max() / 360.0
    assert turns == pytest.approx(round(turns), abs=1e-3)
    assert turns >= 1.0
    assert angle_deg[-1] == pytest.approx(0.0, abs=1e-6)


def test_a_gyro_of_a_small_range_turns_as_far_as_it_can() -> None:
    """A turn at 2 deg/s takes three minutes."""
    assert next_recording_of(["g_sensitivity"], 1.0, Base(dps_per_lsb=1e-4)).profile.seconds == pytest.approx(60.0)


def test_effects_of_one_maneuver_share_it_and_others_get_equal_parts() -> None:
    """Warm air is for the part that needs it."""
    assert len(next_recording_of(["bandwidth", "latency"], 3.0, Base()).maneuvers) == 1
    recording = next_recording_of(["backlash", "warmup"], 3.0, Base())
    assert recording.says.startswith("sharp reversals at 8 deg/s and steps of both signs")
    assert recording.warming == ", and warm the air by 7 °C from 92 to 136 s and let it cool"
    air_c = recording.profile.ambient_at(np.array([0.0, 92.0, 92.5 + 43.75, 179.99]))
    assert air_c == pytest.approx([25.0, 25.0, 25.0 + 43.75 / 6.0, 25.0], abs=0.01)


@pytest.mark.parametrize("name", BY_MANEUVER.values())
def test_the_file_is_the_profile(name: str, tmp_path: Path) -> None:
    recording = next_recording_of([name, "temp_scale"], 3.0, Base(dps_per_lsb=0.0137 / 3.0))
    path = tmp_path / "next-profile.yaml"
    path.write_text(recording.profile_yaml)
    assert load_profile(str(path)) == recording.profile


def test_simulate_takes_the_file(tmp_path: Path) -> None:
    """A profile is played by the command line as it was written."""
    path = tmp_path / "next-profile.yaml"
    path.write_text(next_recording_of(["latency"], 1.0, Base()).profile_yaml)
    assert main(["simulate", "--out", str(tmp_path / "sessions"), "--profile", str(path), "--minutes", "1"]) == 0
    assert (tmp_path / "sessions" / "session-01.mcap").is_file()
