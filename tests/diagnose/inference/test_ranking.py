"""How the effects rank, and which of them look alike."""

import numpy as np
import pytest
from inference_support import SESSIONS, concluded, row, scorer_of, simulated, simulated_at_random

from gyrodrift.diagnose.inference.ranking import ranking, similar_pairs

RATE = simulated("scale_factor", {"rate": 1.0})
BOTH = simulated("clock_drift", {"rate": 1.0, "clock_ratio": 1.0})
FORM = simulated("?moving", {"moving": 1.0})


def test_effects_are_ranked_by_their_evidence_alone() -> None:
    """The cause has nothing to gain beside itself, and the other effect loses; forms of no effect are left out."""
    explanation = concluded({"rate": 6.0}, BOTH, FORM, RATE).explanation
    first, second = ranking(explanation)
    assert (first.name, first.unit, second.name) == ("scale_factor", "%", "clock_drift")
    assert first.gain > 15.0 > second.gain
    assert first.value == pytest.approx(6.0, abs=0.1)
    assert first.gain_with_causes is None
    assert second.gain_with_causes is not None
    assert second.gain_with_causes < 0.0


def test_gain_is_the_log_evidence_over_nothing() -> None:
    """As the posterior has it."""
    explanation = concluded({"rate": 6.0}, RATE).explanation
    evidence = {item.effect_set.names: item.effect_set.without_unknown for item in explanation.posterior.hypotheses}
    (found,) = ranking(explanation)
    assert found.gain == pytest.approx(evidence["scale_factor",] - evidence[()])


def test_what_an_effect_takes_away_is_its_share_of_the_deviations() -> None:
    """Of two features that deviate equally each effect explains its own half."""
    clock = simulated("clock_drift", {"clock_ratio": 1.0})
    shares = [one.takes_away for one in ranking(concluded({"rate": 7.0, "clock_ratio": 7.0}, RATE, clock).explanation)]
    assert shares == pytest.approx([0.5, 0.5], abs=0.02)


def test_where_nothing_deviates_nothing_is_taken_away() -> None:
    """There is no share of nothing."""
    assert [one.takes_away for one in ranking(concluded({}, RATE).explanation)] == [None]


def test_lookalikes_have_their_cosine() -> None:
    """Of (1, 0) and (1, 1) it is the root of a half, too little to be told; of (1, 0) and (1, 0.5) it is 0.89."""
    near = simulated("temp_bias", {"rate": 1.0, "clock_ratio": 0.5})
    form = simulated("?moving", {"rate": 1.0})
    found = similar_pairs([*scorer_of({}, RATE, BOTH, near, form).templates.values()])
    assert [(one.first, one.second) for one in found] == [("clock_drift", "temp_bias"), ("scale_factor", "temp_bias")]
    assert [one.cosine for one in found] == pytest.approx([1.5 / np.sqrt(2.0 * 1.25), 1.0 / np.sqrt(1.25)])


def test_effects_that_only_scatter_have_no_lookalikes() -> None:
    """They move nothing in a direction of their own."""
    signs = np.where(np.arange(16) % 2, 1.0, -1.0)[:, None]
    per_size = np.tile(signs * row({"rate": 1.0}), (SESSIONS, 1, 1))
    scatters = [simulated_at_random(name, per_size) for name in ("scale_factor", "latency")]
    templates = [*scorer_of({}, *scatters).templates.values()]
    assert len(templates) == 2
    assert similar_pairs(templates) == ()
