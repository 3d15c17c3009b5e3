"""Sets of candidates simulated as a whole: against the simulator itself, with the phases of each session."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from simulate_support import BASE, HINTS, candidate_of, feature, plain, session_of

from firmware_sim.effects.effect import Effect
from firmware_sim.rig import Rig, parse_effect
from gyrodrift.diagnose.recording.recording import recording_of
from gyrodrift.diagnose.simulate.candidate import Candidate
from gyrodrift.diagnose.simulate.candidates import candidates
from gyrodrift.diagnose.simulate.response_table import ResponseTable, Sized
from gyrodrift.diagnose.simulate.responses import change_in, in_session, response_table
from gyrodrift.diagnose.simulate.twin import Subject, subject_of
from gyrodrift.values.arrays import Floats

TILT = parse_effect("g_sensitivity:amplitude_dps=0.1,phase_deg=30")


@cache
def table() -> ResponseTable:
    return response_table(plain(), [], null_runs=1)


@cache
def tilted() -> Subject:
    """A session whose rig has an effect once per turn, at a phase that is not the file's."""
    shown = TILT.model_copy(update={"phase_deg": 120.0})
    return subject_of(recording_of(session_of(shown)), Rig(base=BASE, effects=(TILT,)))


def change(*effects: Sized) -> Floats:
    """(F,) in the plain session."""
    changed: Floats = change_in(effects, 0, plain(), table()).change
    return changed


def fresh(name: str) -> Candidate:
    return candidate_of(name)


def test_a_set_is_played_as_one_rig() -> None:
    two = Sized(fresh("scale_factor"), 1.0), Sized(fresh("latency"), 20.0)
    effects: tuple[Effect, ...] = (parse_effect("scale_factor:error_percent=1"), parse_effect("latency:delay_ms=20"))
    with_both = plain().with_remaining_bias(effects)
    by_hand = [with_both.simulated(effects, seed).values - plain().base_run(seed).values for seed in range(3)]
    assert change(*two) == pytest.approx(np.mean(by_hand, axis=0), abs=1e-9)
    result = change_in(two, 0, plain(), table())
    assert result.variance == pytest.approx(np.var(by_hand, axis=0, ddof=1))
    assert result.runs == 3


def test_a_random_one_is_the_mean_of_four() -> None:
    by_hand = [
        plain().simulated((parse_effect("stale_hold:share_percent=2"),), seed).values - plain().base_run(seed).values
        for seed in range(4)
    ]
    assert change(Sized(fresh("stale_hold"), 2.0)) == pytest.approx(np.mean(by_hand, axis=0), abs=1e-9)


def test_what_no_effect_does_is_added_to_the_set() -> None:
    """A slow bias beside a scale error moves the wander, and the rate by what the scale error does."""
    pair = change(Sized(fresh("scale_factor"), 1.0), Sized(fresh("?wander_20s"), 0.2))
    alone = change(Sized(fresh("scale_factor"), 1.0))
    assert feature(pair, "wander_20s") > feature(alone, "wander_20s") + 1.0
    assert feature(pair, "rate") == pytest.approx(feature(alone, "rate"), rel=0.1)


def test_a_free_phase_is_that_of_each_session() -> None:
    free = next(candidate for candidate in candidates(HINTS) if candidate.name == "g_sensitivity")
    sized = Sized(free, 0.1, np.array([30.0, 200.0]))
    assert free.is_phase_free
    assert [in_session(sized, number, plain()).model_dump()["phase_deg"] for number in (0, 1)] == [30.0, 200.0]
    at_200, opposite = change_in([sized], 1, plain(), table()).change, change(replaced(sized, 20.0))
    assert feature(at_200, "turn_sine") == pytest.approx(-feature(opposite, "turn_sine"), rel=0.05)


def replaced(sized: Sized, phase_deg: float) -> Sized:
    return sized._replace(phases_deg=np.array([phase_deg]))


def test_an_effect_in_the_rig_keeps_the_phase_of_the_session() -> None:
    """The file says 30 degrees, and the session 120."""
    rig = Rig(base=BASE, effects=(TILT,))
    on_top = next(candidate for candidate in candidates(HINTS, rig) if candidate.name == "g_sensitivity")
    effect = in_session(Sized(on_top, 0.05), 0, tilted())
    assert effect.model_dump()["amplitude_dps"] == pytest.approx(0.15)
    assert effect.model_dump()["phase_deg"] == pytest.approx(120.0, abs=5.0)


def test_an_effect_in_the_rig_is_replaced() -> None:
    """A session played with another size of it has that size once, not both."""
    none = TILT.model_copy(update={"amplitude_dps": 0.0})
    result = tilted().session((none,), 0)
    without = replace(tilted(), rig=Rig(base=tilted().rig.base)).session((), 0)
    assert np.array_equal(result.rate_dps, without.rate_dps)
