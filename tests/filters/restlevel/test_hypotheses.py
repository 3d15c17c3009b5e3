"""What the hypotheses of restlevel make of a noise that drops, on numbers worked out by hand."""

import pytest

from gyrodrift.filters.restlevel.hypotheses import doubt_loud_rests
from gyrodrift.filters.restlevel.model import RestlevelState
from gyrodrift.filters.restlevel.state import Hypothesis


def test_rests_that_were_louder_than_the_sensor_count_for_a_tenth() -> None:
    """Of a rest at 10 to 1 even odds are left; where every hypothesis has rested, nothing changes."""
    s = RestlevelState()
    s.noise.has_dropped = True
    s.hypotheses[0] = Hypothesis(weight=1.0 / 11.0)
    s.hypotheses[1] = Hypothesis(weight=10.0 / 11.0, knows_bias=True)
    doubt_loud_rests(s)
    assert [h.weight for h in s.hypotheses[:2]] == pytest.approx([0.5, 0.5])
    s.hypotheses[0].knows_bias = True
    doubt_loud_rests(s)
    assert [h.weight for h in s.hypotheses[:2]] == pytest.approx([0.5, 0.5])
