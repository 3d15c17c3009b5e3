"""The report of a tuning: one HTML file for a person, with what was found, how good it is, and how it was done."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from gyrodrift.evaluation.dataset import Split
from gyrodrift.html.html import header, page, paragraph, text, tile, tiles, warnings
from gyrodrift.html.numbers import degrees, mean, significant
from gyrodrift.html.provenance import Provenance, UsedFile, provenance
from gyrodrift.tune.report.alternatives import alternatives
from gyrodrift.tune.report.files import config_text, verdict_words
from gyrodrift.tune.report.method import how_it_was_done
from gyrodrift.tune.report.parameters import parameter, parameters
from gyrodrift.tune.report.search import search
from gyrodrift.tune.report.sessions import by_session, over_time
from gyrodrift.tune.result import SessionScore, Tuning

USES = {Split.TRAIN: "training", Split.TEST: "test"}


def report_html(tuning: Tuning, made: Provenance) -> str:
    """The page of a tuning, and where it comes from; the same for the same of both."""
    body = [
        _verdict(tuning, made.set_name),
        alternatives(tuning),
        parameters(tuning),
        search(tuning),
        over_time(tuning),
        by_session(tuning),
        how_it_was_done(tuning),
        provenance(_made(tuning, made)),
    ]
    return page(
        f"{tuning.filter.title or tuning.filter.name} tuned on {made.set_name}", [part for part in body if part]
    )


def _made(tuning: Tuning, made: Provenance) -> Provenance:
    """With the sessions and what they were used for, and the config that was found."""
    used = [UsedFile(one.session.name, one.session.digest, USES[one.split]) for one in tuning.scores]
    return replace(made, sessions=used, config_text=config_text(tuning))


def _verdict(tuning: Tuning, set_name: str) -> str:
    plain_deg, tuned_deg, where = judged(tuning)
    count = len(tuning.scores)
    return header(
        f"gyrodrift tune · {tuning.filter.title or tuning.filter.name} on {set_name}, "
        f"{count} session{'s' * (count > 1)}",
        _default_headline(tuning) if tuning.is_default_written else _headline(plain_deg, tuned_deg, where),
        warnings("Before believing it", tuning.warnings),
        paragraph(_in_words(tuning)),
        tiles([part for part in (_held_out_tile(tuning), _training_tile(tuning)) if part]),
        paragraph(_what_to_do(tuning, is_better=tuned_deg < plain_deg)),
    )


def judged(tuning: Tuning) -> tuple[float, float, str]:
    """Mean E of plain integration and of the tuned filter, deg, on the most honest sessions there are, and on which."""
    if tuning.scores_on(Split.TEST):
        return *tuning.mean_e_deg(Split.TEST), "on sessions that the tuning never saw"
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


def _in_words(tuning: Tuning) -> str:
    """The verdict as sentences."""
    said = ["Yaw error is how far the angle is off the reference, on average over a session (E)."]
    test, train = tuning.scores_on(Split.TEST), tuning.scores_on(Split.TRAIN)
    if test:
        said += [f"On {_sessions(test, 'test')}, which the search never saw, {_fall(*tuning.mean_e_deg(Split.TEST))}."]
    else:
        said += ["No sessions were held out for a test, so what follows flatters the filter."]
    if train:
        said += [f"On {_sessions(train, 'training')} {_fall(*tuning.mean_e_deg(Split.TRAIN))}."]
    if not test and tuning.cross_validation:
        plain_deg, held_out_deg, _ = judged(tuning)
        said += [
            f"With each session held out of the tuning in turn {_fall(plain_deg, held_out_deg)}: believe this one."
        ]
    if tuning.alternatives:
        said += [f"<b>{text(verdict_words(tuning)[:1].upper() + verdict_words(tuning)[1:])}.</b>"]
    return " ".join(said)


def _sessions(scores: Sequence[SessionScore], kind: str) -> str:
    return f"the {len(scores)} {kind} sessions" if len(scores) > 1 else f"the one {kind} session"


def _fall(plain_deg: float, tuned_deg: float) -> str:
    """What became of the error, as part of a sentence."""
    both = (
        f'plain integration is off by <b class="plain">{degrees(plain_deg)}</b> and the tuned filter by '
        f'<b class="tuned">{degrees(tuned_deg)}</b>'
    )
    if 0.0 < tuned_deg < plain_deg < np.inf:
        return f"{both}, {_times(plain_deg / tuned_deg)}"
    return both


def _times(factor: float) -> str:
    if factor < 1.05:
        return "hardly less"
    return f"{factor:.1f} times less" if factor < 10.0 else f"{significant(factor, 2)} times less"


def _held_out_tile(tuning: Tuning) -> str:
    """The error to expect of a new session, large; nothing where no session was held out."""
    scores = tuning.scores_on(Split.TEST)
    if scores:
        return tile(f"Held out: mean E of {_counted(len(scores))}", _tile_rows(tuning, scores))
    held_out = tuning.cross_validation
    if not held_out:
        return ""
    plain_deg, tuned_deg, _ = judged(tuning)
    rows = [("tuned on the others", degrees(tuned_deg)), ("plain integration", degrees(plain_deg))]
    return tile(f"Each held out in turn: mean E of {_counted(len(held_out))}", rows)


def _training_tile(tuning: Tuning) -> str:
    """The error where it was tuned, which is no promise; never large."""
    scores = tuning.scores_on(Split.TRAIN)
    if not scores:
        return ""
    return tile(f"Training: mean E of {_counted(len(scores))}", _tile_rows(tuning, scores), large=0)


def _tile_rows(tuning: Tuning, scores: Sequence[SessionScore]) -> list[tuple[str, str]]:
    reduced_deg = mean([score.reduced.e_deg for score in scores])
    return [
        ("tuned filter", degrees(mean([score.tuned.e_deg for score in scores]))),
        ("plain integration", degrees(mean([score.euler.e_deg for score in scores]))),
        (f"filter with {tuning.filter.reduced_model.title} tuned", degrees(reduced_deg)),
    ]


def _counted(count: int) -> str:
    return f"{count} session{'s' * (count > 1)}"


def _what_to_do(tuning: Tuning, *, is_better: bool) -> str:
    values = ", ".join(f"<code>{axis.name} {parameter(tuning, axis)}</code>" for axis in tuning.axes)
    found = f"Found: {values}."
    if tuning.is_default_written:
        return f"{found} The YAML file has the defaults of the filter instead: they are better on held-out sessions."
    if not is_better:
        return f"{found} As it stands this is no gain: keep the config you have, and record longer or other sessions."
    return (
        f"{found} They stand in the YAML file that <code>tune</code> wrote: start "
        "<code>gyrodrift serve --port PORT --config FILE.yaml</code> with it, or write it over the file that a running "
        "<code>serve</code> watches, which takes it over between two samples. "
        f"{_where_it_holds(tuning)}"
    )


def _where_it_holds(tuning: Tuning) -> str:
    if tuning.filter.counts_samples:
        rate = f"{tuning.sample_rate_hz:.4g} Hz"
        return (
            f"Steps count samples, so these numbers hold for this sensor at about {rate}; at another rate, tune again."
        )
    return "These numbers hold for this sensor."
