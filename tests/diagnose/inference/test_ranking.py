"""How the effects rank."""

import pytest
from inference_support import concluded, simulated

from gyrodrift.diagnose.inference.ranking import ranking

RATE = simulated("scale_factor", {"rate": 1.0})
PAIR = simulated("clock_drift", {"rate": 1.0, "clock_ratio": 1.0})
FORM = simulated("?moving", {"moving": 1.0})


def test_effects_are_ranked_by_their_evidence_alone() -> None:
    """The cause has nothing to gain beside itself, and the other effect loses; forms of no effect are left out."""
    explanation = concluded({"rate": 6.0}, PAIR, FORM, RATE).explanation
    first, second = ranking(explanation)
    assert (first.name, first.unit, second.name) == ("scale_factor", "%", "clock_drift")
    assert first.gain > 15.0 > second.gain
    assert first.value == pytest.approx(6.0, abs=0.1)
    assert first.gain_with_causes is None
    assert second.gain_with_causes is not None
    assert second.gain_with_causes < 0.0


def test_gain_is_the_log_evidence_over_nothing() -> None:
    explanation = concluded({"rate": 6.0}, RATE).explanation
    evidence = {item.effect_set.names: item.effect_set.without_unknown for item in explanation.posterior.hypotheses}
    (result,) = ranking(explanation)
    assert result.gain == pytest.approx(evidence["scale_factor",] - evidence[()])
