"""The report of a tuning: one HTML file for a person, with what was found, how good it is, and how it was done."""

from collections.abc import Sequence
from math import floor, isfinite, log10

import numpy as np

from gyrodrift import __version__
from gyrodrift.tune.figures import DOTS, density_svgs, drift_svgs, heights, highest_drawn, search_svg
from gyrodrift.tune.page import figure, headings, page, panels, paragraph, section, table, text
from gyrodrift.tune.result import Curve, Pi, Run, SessionScore, Split, Tuning
from gyrodrift.tune.space import Axis

PANELS = 12
"""Sessions in a figure; with more of them the page would be long and say no more."""

AT_BOUND = 0.01
"""A value this close to an end of its range, in shares of it, counts as lying at the bound."""

UNITS = {"i_c_dps": "deg/s per sample", "tau_s": "s", "theta_w_dps": "deg/s"}

MEANINGS = {
    "i_c_dps": "How far the drift estimate moves at each sample. Small: drift is learnt slowly. "
    "Large: the estimate hunts to and fro.",
    "tau_s": "How long the rate is averaged before its sign is looked at. Small: the noise of single samples decides. "
    "Large: it decides late.",
    "theta_w_dps": "Turn switch: above this rate nothing is learnt. Small: learns only near rest, and a bias larger "
    "than this never. Large: slow turns pass for drift.",
    "c1": "How strongly the step shrinks while the rate keeps its sign. 0: not at all. Large: long runs count little.",
    "c2": "How steeply it shrinks as the run gets longer. Small: hardly. Above 1: what one run can correct is bounded.",
}

METHODS = {
    "race": "learning automata look over the whole space in batches, and local searches race from where they point",
    "carla": "continuous action reinforcement learning automata, one a parameter, as published",
    "cma": "CMA-ES, with restarts of growing populations",
    "de": "differential evolution",
    "random": "points at random",
}

KEY = (
    '<span class="plain"><span class="key"></span> plain integration</span> &#160; '
    '<span class="tuned"><span class="key"></span> tuned filter</span>'
)

Numbers = Sequence[float]


def report_html(tuning: Tuning, command: str = "") -> str:
    """The page of a tuning, with the command that made it; the same for the same tuning."""
    body = [
        _verdict(tuning),
        _parameters(tuning),
        _search(tuning),
        _over_time(tuning),
        _by_session(tuning),
        _how(tuning, command),
    ]
    return page("Tuning report", body)


# The verdict


def _verdict(tuning: Tuning) -> str:
    plain_deg, tuned_deg, where = judged(tuning)
    tiles = "\n".join(_tile(tuning, split) for split in (Split.TEST, Split.TRAIN))
    return "\n".join(
        [
            '<header>\n<p class="kicker">gyrodrift tune · report</p>',
            f"<h1>{_headline(plain_deg, tuned_deg, where)}</h1>",
            _warnings(tuning),
            paragraph(_in_words(tuning)),
            f'<div class="tiles">\n{tiles}\n</div>',
            paragraph(_what_to_do(tuning, is_better=tuned_deg < plain_deg)),
            "</header>",
        ]
    )


def judged(tuning: Tuning) -> tuple[float, float, str]:
    """Mean E of plain integration and of the tuned filter, deg, on the most honest sessions there are, and on which."""
    if any(score.split is Split.TEST for score in tuning.scores):
        return *tuning.mean_e_deg(Split.TEST), "on sessions that the tuning never saw"
    left_out = [score for score in tuning.scores if score.name in tuning.left_out]
    if left_out:
        plain_deg = _mean([score.e_euler_deg for score in left_out])
        return plain_deg, _mean([tuning.left_out[score.name] for score in left_out]), "on sessions left out in turn"
    return *tuning.mean_e_deg(Split.TRAIN), "on the sessions it was tuned on"


def _headline(plain_deg: float, tuned_deg: float, where: str) -> str:
    if tuned_deg < plain_deg:
        return f"Yaw error falls from {_degrees(plain_deg)} to {_degrees(tuned_deg)} {where}"
    return f"No gain {where}: yaw error {_degrees(tuned_deg)} tuned, {_degrees(plain_deg)} by plain integration"


def _warnings(tuning: Tuning) -> str:
    if not tuning.warnings:
        return ""
    items = "".join(f"<li>{text(warning)}</li>" for warning in tuning.warnings)
    return f'<div class="warnings" role="note"><strong>Before believing it</strong><ul>{items}</ul></div>'


def _in_words(tuning: Tuning) -> str:
    """The verdict as sentences."""
    said = ["Yaw error is how far the angle is off the reference, on average over a session (E)."]
    test, train = _of(tuning, Split.TEST), _of(tuning, Split.TRAIN)
    if test:
        said += [f"On {_sessions(test, 'test')}, which the search never saw, {_fall(*tuning.mean_e_deg(Split.TEST))}."]
    else:
        said += ["No sessions were kept apart for a test, so what follows flatters the filter."]
    if train:
        said += [f"On {_sessions(train, 'training')} {_fall(*tuning.mean_e_deg(Split.TRAIN))}."]
    if not test and tuning.left_out:
        plain_deg, left_deg, _ = judged(tuning)
        said += [f"With each session left out of the tuning in turn {_fall(plain_deg, left_deg)}: believe this one."]
    return " ".join(said)


def _of(tuning: Tuning, split: Split) -> list[SessionScore]:
    return [score for score in tuning.scores if score.split is split]


def _sessions(scores: Sequence[SessionScore], kind: str) -> str:
    return f"the {len(scores)} {kind} sessions" if len(scores) > 1 else f"the one {kind} session"


def _fall(plain_deg: float, tuned_deg: float) -> str:
    """What became of the error, as part of a sentence."""
    both = (
        f'plain integration is off by <b class="plain">{_degrees(plain_deg)}</b> and the tuned filter by '
        f'<b class="tuned">{_degrees(tuned_deg)}</b>'
    )
    if 0.0 < tuned_deg < plain_deg < np.inf:
        return f"{both}, {_times(plain_deg / tuned_deg)}"
    return both


def _times(factor: float) -> str:
    if factor < 1.05:
        return "hardly less"
    return f"{factor:.1f} times less" if factor < 10.0 else f"{_significant(factor, 2)} times less"


def _tile(tuning: Tuning, split: Split) -> str:
    scores = _of(tuning, split)
    if not scores:
        return ""
    plain_deg, tuned_deg = tuning.mean_e_deg(split)
    kind = "Test" if split is Split.TEST else "Training"
    return (
        f'<div class="tile"><h3>{kind}: mean E of {len(scores)} session{"s" * (len(scores) > 1)}</h3><dl>'
        f'<dt>tuned filter</dt><dd class="main">{_degrees(tuned_deg)}</dd>'
        f"<dt>plain integration</dt><dd>{_degrees(plain_deg)}</dd>"
        f"<dt>filter with two parameters</dt><dd>{_degrees(_mean([score.e_two_deg for score in scores]))}</dd>"
        "</dl></div>"
    )


def _what_to_do(tuning: Tuning, *, is_better: bool) -> str:
    values = ", ".join(f"<code>{axis.name} {_parameter(tuning, axis)}</code>" for axis in tuning.axes)
    found = f"Found: {values}."
    if not is_better:
        return f"{found} As it stands this is no gain: keep the config you have, and record longer or other sessions."
    return (
        f"{found} They stand in the YAML file that <code>tune</code> wrote: start "
        "<code>gyrodrift serve --port PORT --config FILE.yaml</code> with it, or write it over the file that a running "
        "<code>serve</code> watches, which takes it over between two samples. Steps count samples, so these numbers "
        f"hold for this sensor at about {tuning.sample_rate_hz:.4g} Hz; at another rate, tune again."
    )


# Table 1


def _parameters(tuning: Tuning) -> str:
    seeds = 1 + len(tuning.others)
    spread = [f"over {seeds} seeds"] if tuning.others else []
    head = headings(["parameter", "found", *spread, "searched", "where in its range", "what it does"], words=2)
    rows = [_parameter_row(tuning, axis) for axis in tuning.axes]
    caption = "<b>Table 1.</b> The parameters found."
    if any(bound_of(axis, _found(tuning.run, axis)) for axis in tuning.axes):
        caption += (
            " A value at a bound asks for a wider range (<code>--range NAME=LOW:HIGH</code>), unless the filter itself "
            "ends there, as c1 and c2 do at 0."
        )
    return section("Parameters", table(caption, head, rows, words=2), _two_note(tuning))


def _parameter_row(tuning: Tuning, axis: Axis) -> list[str]:
    unit = f' <span class="note">{UNITS[axis.name]}</span>' if axis.name in UNITS else ""
    values = [_found(run, axis) for run in (tuning.run, *tuning.others)]
    spread = [f"{_significant(min(values), 3)} – {_significant(max(values), 3)}"] if tuning.others else []
    searched = f"{_significant(axis.low, 4)} – {_significant(axis.high, 4)}"
    bound = bound_of(axis, values[0])
    mark = f'<span class="mark">at the {bound} bound</span>' if bound else ""
    meaning = f'<div class="meaning">{MEANINGS.get(axis.name, "")}</div>'
    found = f"<b>{_parameter(tuning, axis)}</b>"
    return [f"{text(axis.name)}{unit}", found, *spread, searched, _track(axis, values) + mark, meaning]


def bound_of(axis: Axis, value: float) -> str:
    """Whether a value lies at the lower or the upper bound of its range; empty where it lies inside."""
    at = axis.unit(value)
    if at <= AT_BOUND:
        return "lower"
    return "upper" if at >= 1.0 - AT_BOUND else ""


def _track(axis: Axis, values: Numbers) -> str:
    """A range with a dot at the value and ticks at those of the other seeds."""
    places = [4.0 + 120.0 * axis.unit(value) for value in values]
    ticks = "".join(f'<path d="M{x:.1f} 3V13" stroke="var(--quiet)" stroke-width="1.2"/>' for x in places[1:])
    return (
        f'<svg class="track" viewBox="0 0 128 16" role="img" aria-label="{100 * axis.unit(values[0]):.0f} % of the '
        f'way"><path d="M4 8H124" stroke="var(--grid)" stroke-width="4" stroke-linecap="round"/>{ticks}'
        f'<circle cx="{places[0]:.1f}" cy="8" r="4" fill="var(--tuned)"/></svg>'
    )


def _two_note(tuning: Tuning) -> str:
    two = tuning.two_params
    return paragraph(
        "The filter with two parameters, without low-pass and attenuator, was tuned too: "
        f"i_c_dps {_significant(two.i_c_dps, 4)}, theta_w_dps {_significant(two.theta_w_dps, 4)}. Where it does about "
        "as well on the test sessions, the other three parameters earn nothing.",
        "note",
    )


def _parameter(tuning: Tuning, axis: Axis) -> str:
    return _significant(_found(tuning.run, axis), 4)


def _found(run: Run, axis: Axis) -> float:
    return float(getattr(run.params, axis.name))


# Figures 6 and 7


def _search(tuning: Tuning) -> str:
    cost = figure(f"<b>Figure 6.</b> {_search_words(tuning)}", search_svg(tuning))
    names = [_density_name(tuning, axis) for axis in tuning.axes]
    where = figure(f"<b>Figure 7.</b> {_density_words(tuning)}", panels(names, density_svgs(tuning)))
    return section("The search", cost, _pi_table(tuning), where)


def _search_words(tuning: Tuning) -> str:
    history = tuning.run.history
    finite = history[np.isfinite(history)]
    said = ["The cost PI by iteration, on the training sessions. A dot is one choice of parameters, walked through all"]
    said += [f"of them; the scale counts factors. Seed {tuning.run.seed}.<br/>{_search_key(tuning)}<br/>"]
    if len(finite) > DOTS:
        said += [f"Of {len(finite)} evaluations every {-(-len(finite) // DOTS)}th is drawn."]
    above = int(np.count_nonzero(finite > highest_drawn(tuning)))
    if above:
        said += [f"{above} dearer one{'s' * (above > 1)} lie{'s' * (above == 1)} above the picture."]
    if len(finite) < len(history):
        said += [f"{len(history) - len(finite)} had no finite cost: with such parameters the filter runs away."]
    return " ".join(said)


def _search_key(tuning: Tuning) -> str:
    """What the marks of Figure 6 are."""
    marks = [("note", "dot", "an evaluation"), ("tuned", "key", "best so far")]
    marks += [("tuned", "key thin", "other seeds")] if tuning.others else []
    marks += [("plain", "key dashed", "plain integration"), ("two", "key dotted", "filter with two parameters")]
    return " &#160; ".join(
        f'<span class="{role}"><span class="{mark}"></span> {name}</span>' for role, mark, name in marks
    )


def _density_name(tuning: Tuning, axis: Axis) -> str:
    unit = f", {UNITS[axis.name]}" if axis.name in UNITS else ""
    return f'<b>{text(axis.name)}{unit}</b><span class="note">found: {_parameter(tuning, axis)}</span>'


def _density_words(tuning: Tuning) -> str:
    upright = "The upright line is the value that was written, the best one seen"
    even = "; dotted, at 1: no preference."
    if tuning.run.densities is None:
        return f"Where the last third of the search looked. {upright}{even}"
    return (
        "What the automata learnt: how much more often than at the start each value is tried by the end. A narrow peak "
        f"is a parameter that matters; a flat one hardly does. {upright}, which need not be the peak{even}"
    )


def _pi_table(tuning: Tuning) -> str:
    rows = [
        ("plain integration", tuning.euler),
        ("filter with two parameters", tuning.two),
        ("tuned filter", tuning.run.pi),
    ]
    has_test = any(pi.test is not None for _, pi in rows)
    head = headings(["PI, deg²", "training", *["test"] * has_test])
    cells = [[name, *_pi_cells(pi, has_test=has_test)] for name, pi in rows]
    return table("The cost: mean over the sessions of the mean squared yaw error.", head, cells)


def _pi_cells(pi: Pi, *, has_test: bool) -> list[str]:
    test = "–" if pi.test is None else _significant(pi.test, 4)
    return [_significant(pi.train, 4), *[test] * has_test]


# Figures 8 and 9


def _over_time(tuning: Tuning) -> str:
    train = _shown(tuning, Split.TRAIN)
    test = _shown(tuning, Split.TEST)
    if not train and not test:
        return ""
    parts = [
        _drift_figure(tuning, f"<b>Figure {number}.</b> Yaw error over time, {kind} sessions.", curves)
        for number, kind, curves in ((8, "training", train), (9, "test", test))
        if curves
    ]
    return section("Yaw error over time", *parts)


def _shown(tuning: Tuning, split: Split) -> list[Curve]:
    """The curves of a split; of too many the worst ones, the worst first."""
    curves = [curve for curve in tuning.curves if curve.split is split]
    if len(curves) <= PANELS:
        return curves
    e_deg = {score.name: score.e_hdr_deg for score in _of(tuning, split)}
    return sorted(curves, key=lambda curve: -e_deg.get(curve.name, 0.0))[:PANELS]


def _drift_figure(tuning: Tuning, title: str, curves: Sequence[Curve]) -> str:
    split = curves[0].split
    scales = heights(curves)
    said = [f"{title} {KEY}<br/>All panels have the same scales of degrees."]
    if scales.zoom_deg:
        said += ["Each is drawn twice: whole, and below enlarged so that the tuned filter's error can be read."]
    total = sum(curve.split is split for curve in tuning.curves)
    if total > len(curves):
        said += [f"Of {total} sessions the {len(curves)} with the largest E of the tuned filter, the worst first."]
    scores = {score.name: score for score in _of(tuning, split)}
    names = [_curve_name(curve, scores.get(curve.name)) for curve in curves]
    return figure(" ".join(said), panels(names, drift_svgs(curves, scales)))


def _curve_name(curve: Curve, score: SessionScore | None) -> str:
    name = f'<b title="{text(curve.name)}">{text(curve.name)}</b>'
    if score is None:
        return name
    return (
        f'{name}<span class="note">E <span class="plain">{_degrees(score.e_euler_deg)}</span> → '
        f'<span class="tuned">{_degrees(score.e_hdr_deg)}</span></span>'
    )


# Tables 2 and 3


def _by_session(tuning: Tuning) -> str:
    parts = [
        _scores_table(f"<b>Table {number}.</b> {kind} sessions.", scores)
        for number, kind, scores in (
            (2, "Training", _of(tuning, Split.TRAIN)),
            (3, "Test", _of(tuning, Split.TEST)),
        )
        if scores
    ]
    words = (
        "E is the mean absolute yaw error in degrees, NE is E divided by the session's minutes, in degrees a minute."
    )
    return section("Session by session", paragraph(words), *parts, _left_out_table(tuning))


def _scores_table(caption: str, scores: Sequence[SessionScore]) -> str:
    columns = [
        [score.minutes for score in scores],
        [score.e_euler_deg for score in scores],
        [score.ne_euler for score in scores],
        [score.e_hdr_deg for score in scores],
        [score.ne_hdr for score in scores],
        [score.e_two_deg for score in scores],
    ]
    group = (
        '<tr><th></th><th></th><th colspan="2" class="number plain">plain integration</th>'
        '<th colspan="2" class="number tuned">tuned filter</th><th class="number two">two parameters</th></tr>\n'
    )
    head = group + headings(["session", "minutes", "E", "NE", "E", "NE", "E"])
    marks = ["" if score.e_hdr_deg < score.e_euler_deg else "worse" for score in scores]
    if any(marks):
        caption += " Where the tuned filter is no better than plain integration, the name is marked."
    names = [
        text(score.name) + f' <span class="mark">▲ {mark}</span>' * bool(mark)
        for score, mark in zip(scores, marks, strict=True)
    ]
    return _with_means(caption, head, names, columns)


def _with_means(caption: str, head: str, names: Sequence[str], columns: Sequence[Numbers]) -> str:
    """A table of these columns, each with digits of its own, and with a row of their means."""
    cells = [even([*column, _mean(column)]) for column in columns]
    rows = [[name, *row] for name, row in zip(["mean", *names], _turned(cells), strict=True)]
    return table(caption, head, rows[1:], rows[0])


def _turned(columns: Sequence[Sequence[str]]) -> list[list[str]]:
    """Columns as rows, the last one first: a mean comes after its values."""
    rows = [list(row) for row in zip(*columns, strict=True)]
    return [rows[-1], *rows[:-1]]


def _left_out_table(tuning: Tuning) -> str:
    scores = [score for score in tuning.scores if score.name in tuning.left_out]
    if not scores:
        return ""
    columns = [
        [score.e_euler_deg for score in scores],
        [score.e_hdr_deg for score in scores],
        [tuning.left_out[score.name] for score in scores],
    ]
    head = headings(["session", "plain integration", "tuned on all", "tuned on the others"])
    caption = (
        "<b>Left out in turn.</b> E in degrees of each session under parameters tuned on all others: what to expect "
        "of a new session."
    )
    return _with_means(caption, head, [text(score.name) for score in scores], columns)


# How it was done


def _how(tuning: Tuning, command: str) -> str:
    facts = [
        ("Method", _method(tuning.method)),
        ("Cost", _cost_words()),
        ("Evaluations", f"{tuning.evaluations} a seed"),
        ("Seed", _seed_words(tuning)),
        ("Sample rate", f"{tuning.sample_rate_hz:.6g} Hz"),
        ("Took", f"{_significant(tuning.seconds, 3)} s"),
        ("Made by", f"gyrodrift {text(__version__)}"),
    ]
    rows = "\n".join(f"<dt>{name}</dt><dd>{words}</dd>" for name, words in facts)
    called = f"<pre><code>{text(command)}</code></pre>" if command else ""
    note = paragraph("Figures and tables have the numbers that they have in the published method.", "note")
    return section("How it was done", f'<dl class="facts">\n{rows}\n</dl>', _seeds_table(tuning), called, note)


def _method(name: str) -> str:
    return f"<b>{text(name)}</b>: {METHODS[name]}" if name in METHODS else f"<b>{text(name)}</b>"


def _cost_words() -> str:
    return (
        "PI (equation 9): the squared yaw error, averaged over each session and then over the sessions, so that each "
        "counts the same however long; deg². E (equation 10): the absolute yaw error, averaged over a session; deg. "
        "NE (equation 11): E divided by the session's true duration; deg/min. Yaw and reference are unwrapped and "
        "start at 0."
    )


def _seed_words(tuning: Tuning) -> str:
    if not tuning.others:
        return str(tuning.run.seed)
    others = ", ".join(str(run.seed) for run in tuning.others)
    return f"{tuning.run.seed}, the best on the training sessions; also searched: {others}"


def _seeds_table(tuning: Tuning) -> str:
    """What every seed found, where there was more than one."""
    if not tuning.others:
        return ""
    runs = sorted((tuning.run, *tuning.others), key=lambda run: run.seed)
    has_test = tuning.run.pi.test is not None
    head = headings(["seed", "PI training", *["PI test"] * has_test, *(text(axis.name) for axis in tuning.axes)])
    rows = [
        [
            f"<b>{run.seed}</b>" if run is tuning.run else str(run.seed),
            *_pi_cells(run.pi, has_test=has_test),
            *(_significant(_found(run, axis), 3) for axis in tuning.axes),
        ]
        for run in runs
    ]
    return table("Every seed, the chosen one in bold. PI in deg².", head, rows)


# Numbers


def _mean(values: Numbers) -> float:
    return float(np.mean(values)) if len(values) else float("nan")


def _significant(value: float, digits: int) -> str:
    """A number without an exponent, where it can be read so."""
    if not isfinite(value):
        return _no_number(value)
    if value != 0.0 and not 1e-7 <= abs(value) < 1e9:
        return f"{value:.{digits}g}"
    return np.format_float_positional(value, digits, fractional=False, trim="-")


def _degrees(value: float) -> str:
    return f"{even([value])[0]}°"


def _no_number(value: float) -> str:
    return "∞" if value > 0.0 else "–"


def even(values: Numbers) -> list[str]:
    """Numbers of one column with equally many decimals: three digits at the column's middle."""
    sizes = [abs(value) for value in values if isfinite(value) and value != 0.0]
    middle = float(np.median(sizes)) if sizes else 1.0
    if middle >= 1e9:
        return [_significant(value, 3) for value in values]
    decimals = min(max(2 - floor(log10(middle)), 0), 5)
    return [f"{value:.{decimals}f}" if isfinite(value) else _no_number(value) for value in values]
