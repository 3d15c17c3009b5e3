"""What the hypotheses of restlevel make of a noise that drops and of a rest that ends, on numbers by hand."""

import pytest

from gyrodrift.filters.restlevel.bias_state import Hypothesis, RestMark
from gyrodrift.filters.restlevel.hypotheses import doubt_loud_rests, forgive_exit, leave_segment
from gyrodrift.filters.restlevel.model import RestlevelState


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


def test_a_gentle_end_takes_back_what_was_learned_last() -> None:
    """The bias goes back to what the rest had settled at; an abrupt end, or one that turns out to be, leaves it."""
    for is_gentle, expected in ((True, (0.1, 4.0)), (False, (0.3, 1.0))):
        s = RestlevelState()
        s.ended.ended_gently = is_gentle
        h = Hypothesis(weight=1.0, knows_bias=True, is_at_rest=True, bias_dps=0.3, bias_var=1.0)
        s.hypotheses[0], h.settled = h, RestMark(0.1, 4.0, 6.0)
        leave_segment(s)
        assert (h.bias_dps, h.bias_var) == expected
        if is_gentle:
            forgive_exit(s)
            assert (h.bias_dps, h.bias_var) == (0.3, 1.0)
