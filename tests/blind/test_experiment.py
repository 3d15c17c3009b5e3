"""The check of proposed motions: its cases, its motions at random, and how it counts."""

from pathlib import Path
from typing import Any

import pytest
from blind.experiment import cases, names, random_profile, summary
from blind.gap import read_gap
from blind_support import cause, gap

from firmware_sim.motion.profile import load_profile
from firmware_sim.rig import parse_effect


def test_cases_are_at_least_forty_and_their_effects_exist() -> None:
    every = cases(1)
    assert len({case.name for case in every}) == len({case.seed for case in every}) == len(every) >= 40
    assert all(parse_effect(case.effect).name == case.cause for case in every)


@pytest.mark.parametrize("seed", range(5))
def test_a_motion_at_random_is_a_profile_of_its_length(seed: int, tmp_path: Path) -> None:
    path = tmp_path / "random.yaml"
    path.write_text(random_profile(2.0, seed))
    assert load_profile(str(path)).seconds == pytest.approx(120.0, abs=1e-6)


@pytest.mark.parametrize(
    ("answer", "is_named"),
    [
        (gap("effect", cause("latency", 0.9)), True),
        (gap("effect", cause("latency", 0.9, "bandwidth")), False),
        (gap("effect", cause("bandwidth", 0.9), cause("latency", 0.8)), False),
        (gap("unknown", cause("latency", 0.9)), False),
        (gap("none"), False),
    ],
)
def test_a_cause_is_named_when_it_comes_first_and_alone(answer: object, *, is_named: bool) -> None:
    assert names(read_gap(answer), "latency") is is_named


def test_what_is_not_proposed_is_missed() -> None:
    words = "play it: it tells a from b with probability 0.80; more of the same"
    results: list[dict[str, Any]] = [
        {"at_first": True},
        {"at_first": False, "next": words, "proposed": True, "random": False},
        {"at_first": False, "next": "Record more.", "random": True},
    ]
    statement = summary(results)
    assert statement[0] == "3 cases, 2 tied or undetected at first"
    assert statement[1].startswith("named with the proposed motion: 1 of 2")
    assert statement[2].startswith("named with the random motion: 1 of 2")
    assert statement[3] == "predicted in the mean 0.80, came true 1 of 1"
