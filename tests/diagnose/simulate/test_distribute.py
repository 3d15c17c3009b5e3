"""Response tables of several sessions, in one process and in several."""

from dataclasses import replace

import numpy as np
import pytest
from simulate_support import candidate_of, plain

from gyrodrift.diagnose.simulate import responses
from gyrodrift.diagnose.simulate.distribute import SimulationPlan, response_tables
from gyrodrift.diagnose.simulate.response_table import ResponseTable
from gyrodrift.diagnose.simulate.twin import Subject


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
    plan = SimulationPlan(subjects, TRIED)
    report: list[tuple[str, int, int]] = []
    here = response_tables(plan, 1, lambda *step: report.append(step))
    there = response_tables(plan, 2, lambda *_: None)
    assert [table.name for table in there] == ["a", "b"]
    assert all(same(item, peer) for item, peer in zip(here, there, strict=True))
    assert not same(here[0], here[1])
    assert report == [("sessions replayed", number, 2) for number in (0, 1, 2)]
