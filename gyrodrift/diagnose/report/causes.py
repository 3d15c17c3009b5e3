"""The causes in a report: probability and evidence of every effect, and the effects that were not tried."""

from gyrodrift.diagnose.inference.ranking import Ranked
from gyrodrift.diagnose.report.text import fixed, number, percent, quiet, size, stated
from gyrodrift.diagnose.result import Diagnosis
from gyrodrift.html.html import facts, headings, paragraph, section, span, table, text


def causes(diagnosis: Diagnosis) -> str:
    """The section of the causes."""
    return section(
        "Which effect explains it" if diagnosis.verdict.where else "What each effect would explain",
        paragraph(_introduction(diagnosis)),
        _ranking_table(diagnosis),
        _linear_model(diagnosis),
        facts(_remarks(diagnosis)),
    )


def _introduction(diagnosis: Diagnosis) -> str:
    joined = (
        " Beside the causes: the evidence that the effect adds to the named causes; at 0 or below it is not needed."
        if diagnosis.verdict.acting
        else ""
    )
    return (
        "Every effect of the simulator was tried, alone and in sets of two and three. Probability: that the effect "
        "acts, over all sets that hold it. Evidence alone: the natural logarithm of how many times more probable the "
        "recordings are with the effect than with the simulator as it is, averaged over its sizes, if nothing "
        "unknown acts. An effect with much evidence alone and a small probability imitates a better "
        f"explanation.{joined}"
    )


def _ranking_table(diagnosis: Diagnosis) -> str:
    has_causes = bool(diagnosis.verdict.acting)
    joined = ["beside<br/>the causes"] * has_causes
    head = headings(
        ["effect", "", "probability", "evidence<br/>alone", *joined, "best size", "group"],
        words=1,
    )
    caption = (
        "The effects, the most probable first. Best size: the one that fits best alone. Effects of one group are "
        "easily mistaken for each other."
    )
    in_order = sorted(diagnosis.ranking, key=lambda ranked: (-round(ranked.probability, 2), -ranked.gain))
    return table(caption, head, [_row(diagnosis, ranked) for ranked in in_order], words=1)


def _row(diagnosis: Diagnosis, ranked: Ranked) -> list[str]:
    mark = _mark(diagnosis, ranked.name)
    name = f"<b>{text(ranked.name)}</b>" if mark else text(ranked.name)
    group = ranked.group if ranked.group != ranked.name else ""
    joined = ["" if ranked.gain_with_causes is None else fixed(ranked.gain_with_causes, 1)] * bool(
        diagnosis.verdict.acting
    )
    return [
        span(f"{name}{quiet(mark)}", "word"),
        _bar(ranked.probability),
        text(stated(ranked.probability)),
        fixed(ranked.gain, 1),
        *joined,
        size(ranked.value, ranked.unit),
        group,
    ]


def _mark(diagnosis: Diagnosis, name: str) -> str:
    verdict = diagnosis.verdict
    if name in {cause.effect.name for cause in verdict.causes}:
        return " named"
    if name in {tied for cause in verdict.causes for tied in cause.tied_with}:
        return " tied"
    return " negligible" if name in {item.cause.effect.name for item in verdict.negligible} else ""


def _bar(share: float) -> str:
    """A probability as a bar, in SVG."""
    long = 56.0 * max(share, 0.0)
    return (
        f'<svg class="track short" viewBox="0 0 64 16" role="img" aria-label="{percent(share)}">'
        f'<path d="M4 8H60" stroke="var(--grid)" stroke-width="4"/>'
        f'<path d="M4 8H{4.0 + long:.1f}" stroke="var(--tuned)" stroke-width="6"/></svg>'
    )


def _linear_model(diagnosis: Diagnosis) -> str:
    linear = diagnosis.linear_model
    size_words = ""
    if linear.effect is not None:
        between = f"{number(linear.low)} to {number(linear.high)}"
        size_words = f": {text(linear.parameter)} {size(linear.value, linear.unit)} ({between})"
    return paragraph(
        f"<b>Check by a linear model: it {text(linear.says)}{size_words}.</b> It is a generalized least-squares "
        "regression of the rate error, with a bias that may walk at random. It uses neither the simulator nor the "
        "features, and knows only the effects that are linear. It leaves out effects that are too small to matter for "
        "yaw, such as 0.06 % of scale."
    )


def _remarks(diagnosis: Diagnosis) -> list[tuple[str, str]]:
    """Remarks on ties and on effects that were not tried, with their titles."""
    rows = [
        (f"May act instead of {text(cause.effect.name)}", _tied(cause.tied_with)) for cause in diagnosis.verdict.causes
    ]
    untestable = [f"{text(item.effect)}: {text(item.why)}" for item in diagnosis.untestable]
    return [
        *rows,
        ("Not tried", "; ".join(untestable) or "none"),
        ("Left out by --withhold", ", ".join(map(text, diagnosis.withheld)) or "none"),
    ]


def _tied(names: tuple[str, ...]) -> str:
    return ", ".join(map(text, names)) or "no other"
