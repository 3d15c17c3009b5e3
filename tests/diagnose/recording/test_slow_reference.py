"""References that are slower than the gyro: angles that are held, or missing between the readings."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from firmware_sim.motion.profile import load_profile
from firmware_sim.rig import Base, Rig
from gyrodrift.diagnose.recording.checked import without_held_angles
from gyrodrift.diagnose.recording.recording import recording_of
from gyrodrift.diagnose.recording.reference_response import reference_response_of
from gyrodrift.diagnose.simulate.twin import subject_of
from gyrodrift.session.session import Session
from gyrodrift.simulation.sessions import Simulation
from gyrodrift.values.arrays import Floats

EVERY, RATE_HZ = 10, 100.0
RIG = Rig(base=Base(sample_rate_hz=RATE_HZ, encoder_cpr=4096))
SMOOTH = Rig(base=Base(sample_rate_hz=RATE_HZ, encoder_cpr=1_000_000))


@pytest.fixture(scope="module")
def table() -> Session:
    """A minute of a turntable."""
    return Simulation(RIG, load_profile("turntable"), 3, 0, 1.0).whole()


@pytest.fixture(scope="module")
def smooth() -> Session:
    """A minute with rests and turns of several speeds, whose angle has hardly any steps."""
    return Simulation(SMOOTH, load_profile("turntable"), 3, 0, 1.0).whole()


def frozen(session: Session, every: int) -> Session:
    assert session.encoder_deg is not None
    rows = np.arange(len(session.encoder_deg))
    return replace(session, encoder_deg=session.encoder_deg[rows - rows % every])


def read_at(session: Session, times: Floats) -> Session:
    """A session whose angle is read at these times, in samples, and held in the rows from the next sample on."""
    assert session.encoder_deg is not None
    rows = np.arange(len(session.encoder_deg))
    latest = np.searchsorted(times, rows, side="right") - 1
    readings_deg = CubicSpline(rows, session.encoder_deg)(times)
    return replace(session, encoder_deg=np.where(latest < 0, session.encoder_deg[0], readings_deg[latest]))


def errors_ms(read: Session, session: Session) -> Floats:
    """Times by which the angles of a session are late where it moves, ms."""
    assert read.encoder_deg is not None
    assert session.encoder_deg is not None
    index = np.searchsorted(session.t_device_s, read.t_device_s)
    rate_dps = RATE_HZ * np.gradient(session.encoder_deg)[index]
    counts = np.isfinite(read.encoder_deg) & (np.abs(rate_dps) > 20.0)
    assert np.count_nonzero(counts) > 100
    late_ms: Floats = 1e3 * (session.encoder_deg[index] - read.encoder_deg)[counts] / rate_dps[counts]
    return late_ms


def test_a_held_angle_counts_where_it_was_read(table: Session) -> None:
    read, remark = without_held_angles(frozen(table, EVERY))
    assert read.encoder_deg is not None
    is_read = np.isfinite(read.encoder_deg)
    assert np.count_nonzero(is_read) == pytest.approx(len(is_read) / EVERY, rel=0.02)
    assert np.diff(np.flatnonzero(is_read)).max() <= EVERY
    moves = np.flatnonzero(np.abs(np.diff(read.encoder_deg[is_read])) > 0.0)
    rows = np.flatnonzero(is_read)[moves + 1]
    assert table.encoder_deg is not None
    truth_deg = table.encoder_deg[np.searchsorted(table.t_device_s, read.t_device_s[rows])]
    np.testing.assert_array_equal(read.encoder_deg[rows], truth_deg)
    assert remark.endswith("new in one of 10 samples only; between them it counts as missing")


@pytest.mark.parametrize("every", [1.97, 3.31, 6.62, 14.9])
def test_even_readings_between_the_samples_are_moved_to_the_samples(smooth: Session, every: float) -> None:
    whole = read_at(smooth, np.arange(-0.4, len(smooth.rate_dps), every))
    read, remark = without_held_angles(whole)
    assert np.abs(errors_ms(read, smooth)).max() < 1.0
    assert "moved from the time of its reading to that of its sample" in remark


def test_even_readings_are_found_through_rests_and_lost_readings(smooth: Session) -> None:
    times = np.arange(-0.4, len(smooth.rate_dps), 6.62)
    kept = np.random.default_rng(1).random(len(times)) > 0.05
    read, _ = without_held_angles(read_at(smooth, times[kept]))
    assert np.median(np.abs(errors_ms(read, smooth))) < 0.5


def test_missing_cells_and_repeated_rows_are_no_readings(smooth: Session) -> None:
    """A lost angle spoils no other, and a row that comes twice moves none. Ages count as half a sample then."""
    whole = read_at(smooth, np.arange(-0.4, len(smooth.rate_dps), 6.62))
    assert whole.encoder_deg is not None
    is_lost = np.random.default_rng(1).random(len(whole.rate_dps)) < 0.03
    rows = np.sort(np.concatenate([np.arange(len(is_lost)), np.arange(500, len(is_lost), 500)]))
    holed = replace(whole, encoder_deg=np.where(is_lost, np.nan, whole.encoder_deg)).rows(rows)
    read, _ = without_held_angles(holed)
    assert read.encoder_deg is not None
    assert np.count_nonzero(np.isfinite(read.encoder_deg)) > 0.9 * len(is_lost) / 6.62
    late_ms = errors_ms(read, smooth)
    assert abs(late_ms.mean()) < 1.0
    assert np.percentile(np.abs(late_ms), 95) < 6.0


def test_readings_at_any_time_are_right_on_average(smooth: Session) -> None:
    rng = np.random.default_rng(2)
    times = np.cumsum(rng.uniform(3.0, 7.0, len(smooth.rate_dps) // 5))
    late_ms = errors_ms(without_held_angles(read_at(smooth, times))[0], smooth)
    assert abs(late_ms.mean()) < 0.5
    assert np.percentile(np.abs(late_ms), 95) < 6.0


def test_a_reading_from_before_the_session_does_not_count(smooth: Session) -> None:
    """A session that begins and ends in motion begins and ends with a reading."""
    moving = smooth.part(*np.flatnonzero(np.abs(smooth.rate_dps) > 50.0)[[10, -10]])
    read, _ = without_held_angles(read_at(moving, np.arange(-5.0, len(moving.rate_dps), 6.62)))
    assert read.encoder_deg is not None
    assert np.isfinite(read.encoder_deg[[0, -1]]).all()
    assert np.abs(errors_ms(read, moving)).max() < 1.0


def test_a_slow_reference_has_no_response() -> None:
    """A filter against the error of interpolated angles would smooth the motion, and hide a delay."""
    sessions = [Simulation(SMOOTH, load_profile("turntable"), 3, number, 1.0).whole() for number in (1, 2)]
    times = [np.cumsum(np.random.default_rng(number).uniform(3.0, 7.0, 1200)) for number in (1, 2)]
    slow = [without_held_angles(read_at(*pair))[0] for pair in zip(sessions, times, strict=True)]
    assert reference_response_of([recording_of(session) for session in slow]) is None


@pytest.mark.parametrize("share", [0.0, 0.3])
def test_an_angle_of_each_sample_stays(table: Session, share: float) -> None:
    assert table.encoder_deg is not None
    rows = np.arange(len(table.encoder_deg))
    rows -= np.random.default_rng(1).random(len(rows)) < share
    session = replace(table, encoder_deg=table.encoder_deg[np.maximum(rows, 0)])
    assert without_held_angles(session) == (session, "")


def test_a_simulation_lacks_the_angles_that_the_recording_lacks(table: Session) -> None:
    recording = recording_of(without_held_angles(frozen(table, EVERY))[0])
    played = subject_of(recording, RIG).played((), 1)
    np.testing.assert_array_equal(np.isfinite(played.encoder_deg), np.isfinite(recording.encoder_deg))
    assert np.isfinite(played.rate_dps).all()
