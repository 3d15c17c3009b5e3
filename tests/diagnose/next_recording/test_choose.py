"""The motion that is chosen, and that what is predicted of it comes true."""

from dataclasses import replace

import numpy as np
import pytest

from firmware_sim.motion.profile import load_profile
from firmware_sim.rig import Rig, parse_effect
from gyrodrift.diagnose.next_recording.choose import NextRecording, next_recording_of
from gyrodrift.diagnose.next_recording.information import feature_model
from gyrodrift.diagnose.next_recording.simulated_features import (
    NOTHING,
    PlannedMotion,
    RigHypothesis,
    simulated_features,
)
from gyrodrift.diagnose.what_next import sentence

RIG = Rig()
MINUTES = 2.0


def hypotheses(*texts: str) -> list[RigHypothesis]:
    """Equally likely causes, as a command line says them; an empty one is that there is none."""
    made = [(text.partition(":")[0] or NOTHING, (parse_effect(text),) if text else ()) for text in texts]
    return [RigHypothesis(name, RIG.model_copy(update={"effects": effects}), 0.5) for name, effects in made]


def share_right(actual: NextRecording, requested: list[RigHypothesis]) -> float:
    planned, rigs = PlannedMotion(actual.profile, actual.minutes), [item.rig for item in requested]
    learned = simulated_features(rigs, RIG, planned, 4001, 4)
    model = feature_model(learned, learned.values.mean(axis=1))
    fresh = simulated_features(rigs, RIG, planned, 4002, 8).values
    right = [model.log_likelihoods(values).argmax(axis=1) == number for number, values in enumerate(fresh)]
    return float(np.mean(right))


def test_temperature_and_warming_up_are_told_apart_by_warming_the_air() -> None:
    # 8 °C of self-heating with 240 s times 0.01 deg/s/°C is a bias that settles by 0.08 deg/s with 240 s.
    request = hypotheses("temp_bias:slope_dps_per_c=0.01", "warmup:amplitude_dps=-0.08,time_constant_s=240")
    rest = PlannedMotion(load_profile("rest"), MINUTES)
    result = next_recording_of(request, MINUTES, seed=1, recorded=rest)
    assert any(maneuver.warms_air for maneuver in result.maneuvers)
    assert result.predicted.probability > 0.95
    assert result.repeated is not None
    assert result.repeated.probability < 0.6
    assert share_right(result, request) > 0.9


@pytest.mark.evaluation
def test_a_dead_band_is_looked_for_near_zero() -> None:
    rig = Rig(base=RIG.base.model_copy(update={"bias_dps": 0.35}))
    band = rig.model_copy(update={"effects": (parse_effect("deadband:width_dps=0.05"),)})
    result = next_recording_of(
        [RigHypothesis(NOTHING, rig, 0.5), RigHypothesis("deadband", band, 0.5)], MINUTES, seed=2
    )
    assert "through_zero" in {maneuver.name for maneuver in result.maneuvers}
    assert result.predicted.probability > 0.9
    assert sentence(result, "next.yaml").startswith("Switch the device on and play next.yaml (2 min: ")
    assert "it tells whether there is deadband with probability" in sentence(result, "next.yaml")


def test_what_nothing_shows_and_what_the_same_motion_tells_better_are_said_to_be_so() -> None:
    """Two causes that do the same by definition stay as probable as they were, and the sentence says so."""
    request = hypotheses("scale_factor:error_percent=0.5", "scale_factor:error_percent=0.51")
    result = next_recording_of(request, 1.0, seed=4, recorded=PlannedMotion(load_profile("rest"), 1.0))
    assert result.predicted.probability == pytest.approx(0.5, abs=0.1)
    assert not result.is_worth_it
    assert sentence(result, "next.yaml").startswith("No motion of 1 min tells scale_factor from scale_factor")
    assert result.repeated is not None
    better = replace(result, repeated=replace(result.repeated, information=result.predicted.information + 0.1))
    assert sentence(better, "next.yaml").startswith("Record 1 min more of the same: it tells scale_factor from")


def test_the_same_question_has_the_same_answer() -> None:
    request = hypotheses("", "saturation:limit_dps=150")
    first, second = (next_recording_of(request, 1.0, seed=4, jobs=jobs) for jobs in (1, 2))
    assert first == second
    assert first.predicted.probability > 0.95
