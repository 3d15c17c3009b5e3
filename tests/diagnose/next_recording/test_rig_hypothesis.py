"""Hypotheses that a next recording separates."""

import pytest

from firmware_sim.effects.effect import Effect
from firmware_sim.rig import Rig, parse_effect
from gyrodrift.diagnose.next_recording.simulated_features import RigHypothesis, common_rig, weights_of

LATENCY = parse_effect("latency:delay_ms=13")
BANDWIDTH = parse_effect("bandwidth:cutoff_hz=12")
SCALE = parse_effect("scale_factor:error_percent=1")


def hypothesis(*effects: Effect, weight: float = 1.0) -> RigHypothesis:
    return RigHypothesis("of a test", Rig(effects=effects), weight)


def test_weights_are_shares_of_their_sum() -> None:
    """Three to one is three quarters and one."""
    result = weights_of([hypothesis(LATENCY, weight=0.6), hypothesis(BANDWIDTH, weight=0.2)])
    assert result == pytest.approx([0.75, 0.25])


@pytest.mark.parametrize("weights", [(1.0,), (1.0, 0.0), (1.0, -0.1), (1.0, float("nan"))])
def test_what_is_no_question_is_refused(weights: tuple[float, ...]) -> None:
    """A single hypothesis, or one that is impossible."""
    with pytest.raises(ValueError, match="hypothes"):
        weights_of([hypothesis(LATENCY, weight=weight) for weight in weights])


def test_the_common_rig_holds_what_all_share() -> None:
    """An effect that the rig had before is in every hypothesis, and is no part of the question."""
    rigs = [hypothesis(SCALE, LATENCY), hypothesis(SCALE, BANDWIDTH), hypothesis(SCALE)]
    assert common_rig(rigs).effects == (SCALE,)
