"""The rules: whether what was said of a case is right. A run that failed is never right."""

from collections.abc import Collection, Mapping, Sequence
from itertools import permutations

from gyrogap.answer import SURE_ABOVE
from gyrogap.catalogue import GROUP
from gyrogap.judge import NEAR

from blind.gap import Cause, Outcome, Said

NEGLIGIBLE_DEG = 0.3
"""Mean absolute yaw in a session: what costs less is reported as negligible, and is no cause."""

READ_OFF = frozenset({"deadband", "quantization", "saturation", "encoder_slip", "encoder_quantization"})
"""Effects whose size is read off what they do: without them there is nothing to read, and nothing to say
beforehand."""

HEIGHTS = {"encoder_slip": "step_deg", "spikes": "height_dps"}
"""Of events, how high they are; how often they have to come to be seen is said for a certain height."""


def names_group_first(outcome: Outcome, truth: str) -> bool:
    """The first cause is of the right group."""
    named = _named(outcome)
    return bool(named) and GROUP.get(named[0].effect) == GROUP[truth]


def names_first_or_tied(outcome: Outcome, truth: str) -> bool:
    """The right effect is the first cause, or the first cause says that it is tied with it."""
    named = _named(outcome)
    return bool(named) and truth in named[0].names


def raises_alarm(outcome: Outcome) -> bool:
    """Anything but "none" where there is no gap, a failure too."""
    return outcome.said is None or outcome.said.verdict != "none"


def abstains_at(outcome: Outcome, stages: Sequence[str]) -> bool:
    """It says "unknown" and the worst of the gap is at a right stage, or "partly" and the worst of the leftover is."""
    said = outcome.said
    if said is None or said.verdict not in {"unknown", "partly"}:
        return False
    left = said.where if said.verdict == "unknown" else said.leftover
    return bool(left) and left[0] in stages


def is_not_fooled(outcome: Outcome) -> bool:
    """With the true effect withheld: no confident cause without a leftover; every cause is wrong here."""
    said = outcome.said
    return said is not None and not (said.verdict == "effect" and any(map(_is_confident, said.causes)))


def admits_what_is_missing(outcome: Outcome, truth: str) -> bool:
    """The same, strictly: "unknown", or "partly" with no confident cause but of the group that the truth is in."""
    said = outcome.said
    if said is None or said.verdict not in {"unknown", "partly"}:
        return False
    return all(GROUP.get(cause.effect) == GROUP[truth] for cause in said.named if _is_confident(cause))


def shrinks_further(back: Outcome, withheld: Outcome) -> bool:
    """With the effect back among the candidates less of the gap is left."""
    if back.said is None or withheld.said is None or back.said.after is None:
        return False
    return withheld.said.after is None or back.said.after < withheld.said.after


def names_both(outcome: Outcome, truths: Sequence[str], *, alone: bool) -> bool:
    """Each by a cause of its own, by itself or tied; `alone`: and no other cause is confident."""
    named = _named(outcome)
    for chosen in permutations(range(len(named)), len(truths)):
        fits = all(truth in named[at].names for at, truth in zip(chosen, truths, strict=True))
        others = [cause for at, cause in enumerate(named) if at not in chosen]
        if fits and not (alone and any(map(_is_confident, others))):
            return True
    return False


def invents(outcome: Outcome, truths: Collection[str]) -> bool:
    """A confident cause is not there; a failure counts as one."""
    return outcome.said is None or any(
        _is_confident(cause) and cause.effect not in truths for cause in outcome.said.named
    )


def names_wrong_size(outcome: Outcome, truth: str) -> bool:
    """The effect is named as one that the rig has at another size."""
    cause = cause_of(outcome.said, truth)
    return cause is not None and bool(cause.in_rig)


def would_be_seen(
    without: Outcome, effect: str, parameters: Mapping[str, float], parameter: str, *, falls: bool
) -> bool:
    """By what a run on data without the effect said beforehand; `falls`: a larger effect has a smaller number.

    Of events that are less high than those that the run speaks of, it says nothing. Where that run failed or said
    nothing of any effect, nothing is excused; nor is anything of READ_OFF that it does not list.
    """
    if without.said is None or not without.said.detectable:
        return True
    least = without.said.detectable.get(effect, {})
    if parameter not in least:
        return effect in READ_OFF
    height = HEIGHTS.get(effect, "")
    if height in least and abs(parameters[height]) < least[height]:
        return False
    size = abs(parameters[parameter])
    return size <= least[parameter] if falls else size >= least[parameter]


def fit_is_near(cause: Cause, parameter: str, truth: float) -> bool:
    """Within 20 % of the truth, the sign included."""
    value = cause.parameters.get(parameter)
    return value is not None and abs(value - truth) <= NEAR * abs(truth)


def interval_holds(cause: Cause, parameter: str, truth: float) -> bool:
    """Within the stated interval; a size that is read off the recordings has none, and is near or not."""
    low, high = cause.intervals.get(parameter, (0.0, 0.0))
    return low <= truth <= high if low < high else fit_is_near(cause, parameter, truth)


def cause_of(said: Said | None, truth: str) -> Cause | None:
    """The cause that names an effect by itself."""
    return next((cause for cause in said.named if cause.effect == truth), None) if said else None


def _named(outcome: Outcome) -> tuple[Cause, ...]:
    return outcome.said.named if outcome.said else ()


def _is_confident(cause: Cause) -> bool:
    return cause.probability >= SURE_ABOVE
