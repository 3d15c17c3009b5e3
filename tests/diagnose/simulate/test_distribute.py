"""Response tables of several sessions, in one process and in several."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from simulate_support import BASE, HINTS, candidate_of, plain, session_of

from firmware_sim.rig import Rig
from gyrodrift.diagnose.recording.checked import checked_session
from gyrodrift.diagnose.simulate import responses
from gyrodrift.diagnose.simulate.candidates import candidates
from gyrodrift.diagnose.simulate.distribute import Origin, SimulationPlan, read_and_simulate, response_tables
from gyrodrift.diagnose.simulate.response_table import ResponseTable
from gyrodrift.diagnose.simulate.responses import response_table
from gyrodrift.diagnose.simulate.twin import Subject, subject_of
from gyrodrift.session.files import write_session
from gyrodrift.values.errors import DataError


@pytest.fixture(autouse=True)
def one_null(monkeypatch: pytest.MonkeyPatch) -> None:
    """Null differences take longest, and one shows as well as five who worked it out."""
    monkeypatch.setattr(responses, "NULL_RUNS_LEAST", 1)
    monkeypatch.setattr(responses, "NULL_RUNS_MOST", 1)


TRIED = (candidate_of("scale_factor"), candidate_of("popcorn"))


def named(name: str) -> Subject:
    """The plain session by another name: its realisations are its own."""
    observed = plain().cleaned
    return replace(plain(), cleaned=replace(observed, recording=replace(observed.recording, name=name)))


def same(first: ResponseTable, second: ResponseTable) -> bool:
    return first.responses.keys() == second.responses.keys() and all(
        np.array_equal(item, peer)
        for item, peer in (
            (first.difference, second.difference),
            (first.nulls, second.nulls),
            *((first.responses[key], second.responses[key]) for key in first.responses),
        )
    )


def test_processes_are_handed_loaded_sessions_and_give_what_one_would() -> None:
    subjects = (named("a"), named("b"))
    origins = tuple(Origin(Path(f"/nowhere/{item.cleaned.recording.name}.mcap"), 0) for item in subjects)
    plan = SimulationPlan(origins, subjects, Rig(base=BASE), HINTS, TRIED, 0.0)
    report: list[tuple[str, int, int]] = []
    here = response_tables(plan, 1, None, lambda *step: report.append(step))
    there = response_tables(plan, 2, None, lambda *_: None)
    assert [table.name for table in there] == ["a", "b"]
    assert all(same(item, peer) for item, peer in zip(here, there, strict=True))
    assert not same(here[0], here[1])
    assert report == [("sessions replayed", number, 2) for number in (0, 1, 2)]


def test_a_worker_elsewhere_reads_the_session_and_gives_the_same(tmp_path: Path) -> None:
    path = tmp_path / "plain.csv"
    write_session(path, [session_of()])
    (recording,) = checked_session(path).recordings
    subject = subject_of(recording, Rig(base=BASE))
    names = frozenset(["scale_factor", "popcorn"])
    popcorns = [candidate for candidate in candidates(HINTS) if candidate.name in names]
    read = read_and_simulate(Origin(path, 0), Rig(base=BASE), HINTS, names, 1, 0.0)
    assert same(read, response_table(subject, popcorns, null_runs=1))


def test_a_part_of_a_session_with_an_outage_is_read_as_that(tmp_path: Path) -> None:
    """The second of two is simulated as the worker's own machine would."""
    session, path = session_of(minutes=1.5), tmp_path / "torn.csv"
    write_session(path, [session.part(0, 3500), session.part(4000, 9000)])
    _, recording = checked_session(path).recordings
    read = read_and_simulate(Origin(path, 1), Rig(base=BASE), HINTS, frozenset(), 1, 0.0)
    assert same(read, response_table(subject_of(recording, Rig(base=BASE)), [], 1))


def test_a_session_that_was_changed_meanwhile_is_told(tmp_path: Path) -> None:
    path = tmp_path / "cut.csv"
    write_session(path, [session_of(minutes=0.25)])
    with pytest.raises(DataError, match=r"cut\.csv: changed while"):
        read_and_simulate(Origin(path, 0), Rig(base=BASE), HINTS, frozenset(), 1, 0.0)
