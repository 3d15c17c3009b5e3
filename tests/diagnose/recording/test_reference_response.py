"""Response from a reference to the gyro: learned from recordings that share it, and removed."""

from dataclasses import replace

import numpy as np
import pytest

from gyrodrift.diagnose.recording.recording import Recording, recording_of
from gyrodrift.diagnose.recording.reference_response import ReferenceResponse, reference_response_of
from gyrodrift.session.session import Session
from gyrodrift.values.arrays import Floats

RATE_HZ, GAIN, LATE = 50.0, 0.98, 2
NOISE_DPS = 0.05


def motion_dps(seed: int) -> Floats:
    """Slow steps of both signs with quick motion on top, each followed by a rest."""
    rng = np.random.default_rng(seed)
    steps_dps = np.repeat(rng.uniform(-20.0, 20.0, 30), 60) + rng.normal(0.0, 20.0, 1800)
    moves = np.arange(1800) % 60 < 40
    return np.convolve(moves * steps_dps, np.hanning(9) / np.hanning(9).sum(), "same")


def observed(seed: int, gain: float = GAIN, late: int = LATE) -> Recording:
    """A gyro that turns `gain` times as far as its reference, and so many samples later; its bias is 0.4 deg/s."""
    rate_dps = motion_dps(seed)
    turned_deg = np.concatenate([[0.0], np.cumsum(0.5 * (rate_dps[1:] + rate_dps[:-1]))]) / RATE_HZ
    noise_dps = np.random.default_rng(100 + seed).normal(0.0, NOISE_DPS, len(rate_dps))
    session = Session(
        name=f"{seed}",
        seq=None,
        t_device_s=np.arange(len(rate_dps)) / RATE_HZ,
        rate_dps=gain * np.roll(rate_dps, late) + 0.4 + noise_dps,
        encoder_deg=turned_deg,
        temp_c=None,
        t_host_s=None,
    )
    return recording_of(session)


def test_gain_and_delay_of_a_bench_are_found_and_leave_the_noise() -> None:
    response = reference_response_of([observed(1), observed(2)])
    assert response is not None
    assert response.gain == pytest.approx(GAIN, abs=1e-3)
    assert response.delay_s == pytest.approx(LATE / RATE_HZ, abs=1e-3)
    middle = len(response.weights) // 2
    assert int(np.argmax(response.weights)) == middle - LATE
    corrected = response.applied(observed(3))
    turned_dps = np.diff(corrected.encoder_deg) * RATE_HZ
    left_dps = 0.5 * (corrected.rate_dps[1:] + corrected.rate_dps[:-1]) - turned_dps - 0.4
    assert np.std(left_dps[20:-20]) < 1.5 * NOISE_DPS / np.sqrt(2.0)


def test_a_reference_that_turns_as_the_gyro_does_is_left() -> None:
    assert reference_response_of([observed(1, gain=1.0, late=0), observed(2, gain=1.0, late=0)]) is None


def test_steps_of_an_encoder_are_left() -> None:
    step_deg = 360.0 / 4096.0
    stepped = [
        replace(item, encoder_deg=np.floor(item.encoder_deg / step_deg) * step_deg)
        for item in (observed(1), observed(2))
    ]
    assert reference_response_of(stepped) is None


def test_of_one_recording_nothing_can_be_held_out() -> None:
    assert reference_response_of([observed(1)]) is None


def test_a_response_that_recordings_do_not_share_is_not_used() -> None:
    """The second is late by as much as the first is early."""
    assert reference_response_of([observed(1, late=4), observed(2, late=-4)]) is None


def test_a_jump_of_the_angle_is_no_motion() -> None:
    """The reference jumps at once, by as much as before."""
    response = ReferenceResponse((0.5, 0.5, 0.0), 1.0 / RATE_HZ)
    still, jumped = observed(1), observed(1)
    jumped.encoder_deg[900:] += 5.0
    added_deg = response.applied(jumped).encoder_deg - response.applied(still).encoder_deg
    assert added_deg == pytest.approx(np.where(np.arange(len(added_deg)) < 900, 0.0, 5.0), abs=0.05)


def test_missing_angles_stay_missing_and_the_beginning_stays() -> None:
    """A response of 1 at the same moment changes nothing."""
    holed = observed(1)
    holed.encoder_deg[[3, 700]] = np.nan
    same = ReferenceResponse((0.0, 1.0, 0.0), 1.0 / RATE_HZ).applied(holed)
    assert np.array_equal(np.isnan(same.encoder_deg), np.isnan(holed.encoder_deg))
    assert same.encoder_deg == pytest.approx(holed.encoder_deg, nan_ok=True)
