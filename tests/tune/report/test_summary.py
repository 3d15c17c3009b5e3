"""The result of a tuning on the terminal."""

from dataclasses import replace

from tuning_support import tuning_of_both

from gyrodrift.tune.report.files import summary
from gyrodrift.tune.result import Tuning

MOTION = "Longest motion without a rest in these sessions: 16 s; the parameters are not tested on longer motion"


def with_motions(*motions_s: float | None) -> Tuning:
    """A tuning on sessions with these longest motions."""
    tuning = tuning_of_both()
    pairs = zip(tuning.scores, motions_s, strict=True)
    scores = [replace(score, session=replace(score.session, longest_motion_s=motion_s)) for score, motion_s in pairs]
    return replace(tuning, scores=tuple(scores))


def test_the_longest_motion_of_the_sessions_limits_the_tuned_parameters() -> None:
    """Longer motion may need other parameters."""
    assert MOTION in summary(with_motions(4.0, 16.0, None, 12.0))


def test_no_limit_is_stated_for_defaults_or_without_a_motion() -> None:
    """The defaults do not come from these sessions."""
    defaults = replace(with_motions(4.0, 16.0, None, 12.0), is_default_written=True)
    for tuning in (defaults, with_motions(None, None, None, None)):
        assert not [line for line in summary(tuning) if "longest motion" in line]
