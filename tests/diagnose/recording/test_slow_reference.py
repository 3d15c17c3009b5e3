"""References that are slower than the gyro: angles that are held, or missing between the readings."""

from dataclasses import replace

import numpy as np
import pytest

from firmware_sim.motion.profile import load_profile
from firmware_sim.rig import Base, Rig
from gyrodrift.diagnose.recording.checked import without_held_angles
from gyrodrift.diagnose.recording.recording import recording_of
from gyrodrift.diagnose.simulate.twin import subject_of
from gyrodrift.session.session import Session
from gyrodrift.simulation.sessions import Simulation

EVERY = 10
RIG = Rig(base=Base(sample_rate_hz=100.0, encoder_cpr=4096))


@pytest.fixture(scope="module")
def table() -> Session:
    """A minute of a turntable."""
    return Simulation(RIG, load_profile("turntable"), 3, 0, 1.0).whole()


def held(session: Session, every: int) -> Session:
    assert session.encoder_deg is not None
    rows = np.arange(len(session.encoder_deg))
    return replace(session, encoder_deg=session.encoder_deg[rows - rows % every])


def test_a_held_angle_counts_where_it_was_read(table: Session) -> None:
    """In motion and at rest alike, and the remark names the rate of the readings."""
    read, remark = without_held_angles(held(table, EVERY))
    assert read.encoder_deg is not None
    assert table.encoder_deg is not None
    is_read = np.isfinite(read.encoder_deg)
    assert np.count_nonzero(is_read) == pytest.approx(len(is_read) / EVERY, rel=0.02)
    assert np.diff(np.flatnonzero(is_read)).max() <= EVERY
    moves = np.flatnonzero(np.abs(np.diff(read.encoder_deg[is_read])) > 0.0)
    rows = np.flatnonzero(is_read)[moves + 1]
    np.testing.assert_array_equal(read.encoder_deg[rows], table.encoder_deg[rows])
    assert "new in one of 10 samples only" in remark


@pytest.mark.parametrize("share", [0.0, 0.3])
def test_an_angle_of_each_sample_stays(table: Session, share: float) -> None:
    """Also if some of its samples repeat the last."""
    assert table.encoder_deg is not None
    rows = np.arange(len(table.encoder_deg))
    rows -= np.random.default_rng(1).random(len(rows)) < share
    session = replace(table, encoder_deg=table.encoder_deg[np.maximum(rows, 0)])
    assert without_held_angles(session) == (session, "")


def test_a_simulation_lacks_the_angles_that_the_recording_lacks(table: Session) -> None:
    """What is interpolated between the readings then has the same errors on both sides."""
    recording = recording_of(without_held_angles(held(table, EVERY))[0])
    played = subject_of(recording, RIG).played((), 1)
    np.testing.assert_array_equal(np.isfinite(played.encoder_deg), np.isfinite(recording.encoder_deg))
    assert np.isfinite(played.rate_dps).all()
