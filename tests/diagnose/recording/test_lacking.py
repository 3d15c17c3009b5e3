"""Values that recordings lack: what only one of two sets has is neither compared nor a gap."""

from dataclasses import replace
from functools import cache

from simulate_support import BASE, MOTION

from firmware_sim.rig import Rig
from gyrodrift.diagnose.recording.lacking import lacking_values
from gyrodrift.diagnose.recording.recording import Recording, recording_of
from gyrodrift.session.checks.stated import COUNTER, HOST_TIMES, TEMPERATURE, ReadingOptions
from gyrodrift.simulation.sessions import Simulation

WHOLE = Simulation(Rig(base=BASE), MOTION, seed=1, minutes=1.0).whole()


@cache
def whole() -> Recording:
    return recording_of(WHOLE)


def exact() -> Recording:
    """Recording of a simulator: no counter, no host, no temperature, no steps."""
    session = replace(WHOLE, seq=None, t_host_s=None, temp_c=None)
    recording = recording_of(session)
    return replace(recording, rate_dps=recording.rate_dps + 1e-3 * recording.device_s**0.5)


def test_a_set_lacks_what_one_of_its_recordings_lacks() -> None:
    """Columns and steps, by their names in the report."""
    lacking = lacking_values([whole(), whole()], [whole(), exact()])
    assert set(lacking.sessions) <= {"steps of the encoder"}  # a fine encoder hardly shows its own
    assert lacking.baseline[:4] == (COUNTER, HOST_TIMES, TEMPERATURE, "steps of the rate")


def test_columns_of_one_set_are_left_out_with_a_remark() -> None:
    """Steps are no columns; another part of the comparison decides on them."""
    lacking = lacking_values([whole()], [exact()])
    assert lacking.of_one_set == {COUNTER, HOST_TIMES}
    constant, remark = lacking.remarks
    assert "no temperature, which counts as constant" in constant
    assert "counter and host times: this is no gap" in remark
    assert lacking_values([exact()], [whole()]).of_one_set == {COUNTER, HOST_TIMES, TEMPERATURE}


def test_what_both_sets_lack_needs_no_remark() -> None:
    lacking = lacking_values([exact()], [exact()])
    assert lacking.of_one_set == frozenset()
    assert lacking.remarks == []


def test_a_reader_leaves_columns_out() -> None:
    session = ReadingOptions(without=frozenset({HOST_TIMES})).applied(WHOLE)
    assert session.t_host_s is None
    assert session.seq is not None
    assert session.temp_c is not None
    bare = ReadingOptions(without=frozenset({COUNTER, TEMPERATURE})).applied(WHOLE)
    assert (bare.seq, bare.temp_c) == (None, None)
    assert bare.t_host_s is not None
