"""The sentence for what to record next."""

from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import pytest
from diagnosis_support import SCALED, diagnosis

from firmware_sim.rig import Rig
from gyrodrift.diagnose.inference.explanation import Explanation
from gyrodrift.diagnose.inference.verdict import Kind, Verdict
from gyrodrift.diagnose.result import Untestable
from gyrodrift.diagnose.simulate.twin import Subject
from gyrodrift.diagnose.what_next import what_next


@pytest.fixture(scope="module")
def named() -> Verdict:
    """One cause that explains all of the gap."""
    verdict = diagnosis(SCALED).verdict
    gap = replace(verdict.gap, shrink=1.0)
    return replace(verdict, kind=Kind.EFFECT, unexplained=(), gap=gap, probability_unknown=0.0)


def sentence(verdict: Verdict, *untestable: Untestable, sessions: int = 4) -> str:
    subjects = [cast("Subject", SimpleNamespace(rig=Rig()))] * sessions
    return what_next(verdict, cast("Explanation", None), subjects, untestable, Rig()).sentence


def test_nothing_is_needed_where_the_gap_is_closed_and_nothing_deviates(named: Verdict) -> None:
    assert sentence(named) == "Nothing: no ambiguity remains. Record again after a change."


@pytest.mark.promise("Analyses and reports")
def test_a_gap_that_is_open_by_15_percent_needs_more(named: Verdict) -> None:
    """`diagnose` says "nothing more to record" only with 85 % of the gap closed and no deviating feature."""
    opened = replace(named, gap=replace(named.gap, shrink=0.84))
    assert sentence(opened).startswith("Record longer sessions")
    assert sentence(replace(named, kind=Kind.PARTLY)).startswith("Record longer sessions")


def test_something_unknown_that_may_act_needs_more(named: Verdict) -> None:
    """A posterior probability of 0.3 is no certainty."""
    assert "with probability 0.30" in sentence(replace(named, probability_unknown=0.3))
    assert sentence(replace(named, probability_unknown=0.1)).startswith("Nothing")


def test_a_size_beyond_the_tried_sizes_needs_a_check(named: Verdict) -> None:
    (cause,) = named.causes
    bound = replace(cause, parameters=(replace(cause.parameters[0], is_at_least=True),))
    assert "Check scale_factor by hand" in sentence(replace(named, causes=(bound,)))


def test_a_feature_that_still_deviates_says_where_to_look(named: Verdict) -> None:
    (worst, *_) = named.where
    assert worst.says in sentence(replace(named, unexplained=(worst,)))
    within = replace(worst, is_beyond_chance=False)
    assert worst.says not in sentence(replace(named, unexplained=(within,)))


def test_few_sessions_and_silent_devices_come_first(named: Verdict) -> None:
    """Sessions check each other from three on; a device without a temperature hides effects."""
    lacking = Untestable("temp_bias", "no temperature")
    assert sentence(named, lacking, sessions=2).startswith("Record more sessions")
    assert "no temperature here, so temp_bias was not tested" in sentence(named, lacking)


def test_a_cause_that_no_motion_tells_from_another_needs_three_axes(named: Verdict) -> None:
    """A tilt ties with a scale error; where it does not, its missing axes are no reason to record."""
    explanation = cast("Explanation", SimpleNamespace(where_best=lambda _: None))
    (cause,) = named.causes
    tied = replace(named, causes=(replace(cause, tied_with=("misalignment",)),))
    subjects = [cast("Subject", SimpleNamespace(rig=Rig()))] * 4
    lacking = [Untestable("misalignment", "no rates about x and y")]
    following = what_next(tied, explanation, subjects, lacking, Rig())
    assert following.sentence.startswith("Record with three axes")
    assert "tell scale_factor from misalignment" in following.sentence
    assert following.profile_yaml is None
    assert sentence(named, *lacking).startswith("Nothing: no ambiguity remains")


def test_tied_causes_get_the_motion_that_tells_them_apart(named: Verdict) -> None:
    """A scale error and a lag: several speeds, and quick changes."""
    explanation = cast("Explanation", SimpleNamespace(where_best=lambda name: name))
    (cause,) = named.causes
    tied = replace(named, causes=(replace(cause, tied_with=("latency",)),))
    recording = SimpleNamespace(seconds=180.0)
    subject = SimpleNamespace(rig=Rig(), cleaned=SimpleNamespace(recording=recording))
    following = what_next(tied, explanation, [cast("Subject", subject)] * 4, [], Rig())
    assert following.sentence.startswith("Switch the device on and play next-profile.yaml (3 min: steps of both signs")
    assert following.sentence.endswith("such motion tells scale_factor from latency best.")
    assert following.profile_yaml is not None
    assert "multisine" in following.profile_yaml
