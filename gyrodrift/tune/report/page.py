"""Report of a tuning: one HTML file with result, scores and method."""

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
    """Page of a tuning with its provenance."""
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
    """Provenance with the sessions, their use, and the config."""
    used = [UsedFile(score.session.name, score.session.digest, USES[score.split]) for score in tuning.scores]
    return replace(made, sessions=used, config_text=config_text(tuning))


def _verdict(tuning: Tuning, set_name: str) -> str:
    plain_deg, tuned_deg, where = judged(tuning)
    count = len(tuning.scores)
    return header(
        f"gyrodrift tune · {tuning.filter.title or tuning.filter.name} on {set_name}, "
        f"{count} session{'s' * (count > 1)}",
        _default_headline(tuning) if tuning.is_default_written else _headline(plain_deg, tuned_deg, where),
        warnings("Warnings", tuning.warnings),
        paragraph(_in_words(tuning)),
        tiles([part for part in (_held_out_tile(tuning), _training_tile(tuning)) if part]),
        paragraph(_what_to_do(tuning, is_better=tuned_deg < plain_deg)),
    )


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


def _in_words(tuning: Tuning) -> str:
    """The verdict as sentences."""
    sentences = ["Yaw error E is the mean absolute difference of yaw and reference over a session."]
    test, train = tuning.scores_on(Split.TEST), tuning.scores_on(Split.TRAIN)
    if test:
        sentences += [f"On {_sessions(test, 'test')} {_fall(*tuning.mean_e_deg(Split.TEST))}."]
    else:
        sentences += ["No sessions were held out, so the errors below are too optimistic."]
    if train:
        sentences += [f"On {_sessions(train, 'training')} {_fall(*tuning.mean_e_deg(Split.TRAIN))}."]
    if not test and tuning.cross_validation:
        plain_deg, held_out_deg, _ = judged(tuning)
        sentences += [
            f"With each session held out in turn, {_fall(plain_deg, held_out_deg)}: this is the error to expect."
        ]
    if tuning.alternatives:
        sentences += [f"<b>{text(verdict_words(tuning)[:1].upper() + verdict_words(tuning)[1:])}.</b>"]
    return " ".join(sentences)


def _sessions(scores: Sequence[SessionScore], kind: str) -> str:
    return f"the {len(scores)} {kind} sessions" if len(scores) > 1 else f"the one {kind} session"


def _fall(plain_deg: float, tuned_deg: float) -> str:
    """Errors of plain integration and the tuned filter, as part of a sentence."""
    errors = (
        f'plain integration is off by <b class="plain">{degrees(plain_deg)}</b> and the tuned filter by '
        f'<b class="tuned">{degrees(tuned_deg)}</b>'
    )
    if 0.0 < tuned_deg < plain_deg < np.inf:
        return f"{errors}, {_times(plain_deg / tuned_deg)}"
    return errors


def _times(factor: float) -> str:
    if factor < 1.05:
        return "almost the same"
    return f"{factor:.1f} times less" if factor < 10.0 else f"{significant(factor, 2)} times less"


def _held_out_tile(tuning: Tuning) -> str:
    """Tile of the error to expect on a new session; empty without held-out sessions."""
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
    """Tile of the error on the training sessions."""
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
    sentence = f"Found: {values}."
    if tuning.is_default_written:
        return f"{sentence} The YAML file has the defaults of the filter instead: they are better on held-out sessions."
    if not is_better:
        return f"{sentence} This is no gain: keep your config, and record longer or other sessions."
    return (
        f"{sentence} They are in the YAML file that <code>tune</code> wrote. Start "
        "<code>gyrodrift serve --port PORT --config FILE.yaml</code> with it, or replace the config of a running "
        "<code>serve</code>, which reloads it between two samples. "
        f"{_where_it_holds(tuning)}"
    )


def _where_it_holds(tuning: Tuning) -> str:
    if tuning.filter.counts_samples:
        rate = f"{tuning.sample_rate_hz:.4g} Hz"
        return f"Some parameters count samples: the values hold for this sensor at about {rate} only."
    return "The values hold for this sensor."
