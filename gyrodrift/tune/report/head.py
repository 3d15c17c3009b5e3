"""Head of a tuning's report: verdict in words, errors as tiles, and what to do next."""

from collections.abc import Sequence

import numpy as np

from gyrodrift.evaluation.dataset import Split
from gyrodrift.report.numbers import degrees, mean, significant
from gyrodrift.report.page import Section
from gyrodrift.tune.report.files import verdict_words
from gyrodrift.tune.report.parameters import found_value
from gyrodrift.tune.result import SessionScore, Tuning


def head(tuning: Tuning, set_name: str) -> Section:
    """The head of the page."""
    plain_deg, tuned_deg, where = judged(tuning)
    test, train = tuning.scores_on(Split.TEST), tuning.scores_on(Split.TRAIN)
    in_config = verdict_words(tuning)
    values = {
        "tuning": tuning,
        "set_name": set_name,
        "headline": _default_headline(tuning) if tuning.is_default_written else _headline(plain_deg, tuned_deg, where),
        "test": _fall("test", len(test), *tuning.mean_e_deg(Split.TEST)) if test else None,
        "train": _fall("training", len(train), *tuning.mean_e_deg(Split.TRAIN)) if train else None,
        "held_out": _fall("", 0, plain_deg, tuned_deg) if tuning.cross_validation and not test else None,
        "in_config": in_config[:1].upper() + in_config[1:],
        "held_out_deg": (plain_deg, tuned_deg),
        "means": {
            kind: [_mean_deg(scores, name) for name in ("tuned", "euler", "reduced")]
            for kind, scores in (("test", test), ("training", train))
        },
        "counts": {"test": len(test), "training": len(train), "held out": len(tuning.cross_validation)},
        "parameters": [f"{axis.name} {found_value(tuning, axis)}" for axis in tuning.axes],
        "is_better": tuned_deg < plain_deg,
    }
    return Section("tune/report/templates/head.html", values)


def judged(tuning: Tuning) -> tuple[float, float, str]:
    """Mean E of plain integration and of the tuned filter, deg, on held-out sessions if there are any, and where."""
    if tuning.scores_on(Split.TEST):
        return *tuning.mean_e_deg(Split.TEST), "on held-out sessions"
    held_out = [score for score in tuning.scores if score.session.name in tuning.cross_validation]
    if held_out:
        plain_deg = mean([score.euler.e_deg for score in held_out])
        tuned_deg = mean([tuning.cross_validation[score.session.name].e_deg for score in held_out])
        return plain_deg, tuned_deg, "on sessions held out in turn"
    return *tuning.mean_e_deg(Split.TRAIN), "on the sessions it was tuned on"


def _headline(plain_deg: float, tuned_deg: float, where: str) -> str:
    if tuned_deg < plain_deg:
        return f"Yaw error falls from {degrees(plain_deg)} to {degrees(tuned_deg)} {where}"
    return f"No gain {where}: yaw error {degrees(tuned_deg)} tuned, {degrees(plain_deg)} by plain integration"


def _default_headline(tuning: Tuning) -> str:
    """Headline if no tuned filter is better than the defaults of a filter."""
    best = tuning.written
    if best is None:
        return "Defaults are best"
    e_deg = best.e_deg.train if best.e_deg.test is None else best.e_deg.test
    return f"No tuned filter is better than {best.title}: yaw error {degrees(e_deg)} on held-out sessions"


def _fall(kind: str, count: int, plain_deg: float, tuned_deg: float) -> dict[str, str]:
    """Names of the sessions, and errors of plain integration and of the tuned filter with their ratio in words."""
    sessions = f"the {count} {kind} sessions" if count > 1 else f"the one {kind} session"
    times = ""
    if 0.0 < tuned_deg < plain_deg < np.inf:
        factor = plain_deg / tuned_deg
        number = f"{factor:.1f}" if factor < 10.0 else significant(factor, 2)
        times = f", {number} times less" if factor >= 1.05 else ", almost the same"
    return {"sessions": sessions, "plain": degrees(plain_deg), "tuned": degrees(tuned_deg), "times": times}


def _mean_deg(scores: Sequence[SessionScore], name: str) -> float:
    """Mean E of plain integration, the tuned or the reduced filter."""
    return mean([getattr(score, name).e_deg for score in scores])
