"""Repeated runs of a motion share their responses."""

from dataclasses import replace

import numpy as np
from simulate_support import candidate_of, plain

from gyrodrift.diagnose.simulate.repeats import is_shared, twins_of, with_shared
from gyrodrift.diagnose.simulate.response_table import ResponseTable
from gyrodrift.diagnose.simulate.twin import Subject

NONE = np.zeros(1)


def table_of(name: str, **values: float) -> ResponseTable:
    responses = {f"{key} ": np.full((1, 1, 1), value) for key, value in values.items()}
    return ResponseTable(name, NONE, NONE, NONE, NONE, responses)


def moved(subject: Subject, factor: float) -> Subject:
    """The subject with another motion: all rates times a factor."""
    mean = subject.posterior.mean
    return replace(subject, posterior=replace(subject.posterior, mean=replace(mean, rate_dps=factor * mean.rate_dps)))


def warmer(subject: Subject, rise_c: float) -> Subject:
    """The subject with another temperature."""
    mean = subject.posterior.mean
    return replace(subject, posterior=replace(subject.posterior, mean=replace(mean, sensor_c=mean.sensor_c + rise_c)))


def test_two_runs_of_a_motion_are_simulated_and_the_others_take_their_responses() -> None:
    """A run with more noise, another temperature, another motion or no counter is no repetition."""
    noisy, warm, fast = plain().with_noise(1.5), warmer(plain(), 5.0), moved(plain(), 1.2)
    cleaned = plain().cleaned
    without = replace(plain(), cleaned=replace(cleaned, recording=replace(cleaned.recording, has_counter=False)))
    subjects = [plain(), plain(), noisy, plain(), warm, without, noisy, noisy, plain(), fast, moved(plain(), 1.05)]
    assert twins_of(subjects) == [(), (), (), (0, 1), (), (), (), (2, 6), (0, 1), (), (0, 1)]


def test_a_response_of_other_runs_is_their_mean_or_one_of_their_draws() -> None:
    tried = [candidate_of("latency"), candidate_of("popcorn"), candidate_of("scale_factor")]
    tried[1] = replace(tried[1], variant="")
    simulated = [table_of("a", latency=1.0, popcorn=3.0, scale_factor=5.0), table_of("b", latency=2.0, popcorn=4.0)]
    own = table_of("c", scale_factor=6.0)
    *_, third, fourth = with_shared([*simulated, own, own], [(), (), (0, 1), (0, 1)], tried)
    assert {name: float(values.item()) for name, values in third.responses.items()} == {
        "latency ": 1.5, "popcorn ": 3.0, "scale_factor ": 6.0,
    }  # fmt: skip
    assert fourth.responses["popcorn "].item() == 4.0


def test_what_depends_on_the_angle_or_on_levels_is_not_shared() -> None:
    """Phases and sizes that are read off belong to each run."""
    names = ("latency", "popcorn", "?ripple", "encoder_eccentricity", "deadband", "scale_factor", "usb_batching")
    assert [name for name in names if is_shared(candidate_of(name))] == ["latency", "popcorn", "?ripple"]
