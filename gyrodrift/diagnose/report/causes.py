"""Which effect it is, in a report: every candidate in a row, those that look alike, those that could not be tried."""

from math import isfinite

from gyrodrift.diagnose.inference.ranking import Ranked
from gyrodrift.diagnose.report.text import fixed, number, percent, quiet, size
from gyrodrift.diagnose.result import Diagnosis
from gyrodrift.html.html import facts, headings, paragraph, section, span, table, text

PAIRS = 8


def causes(diagnosis: Diagnosis) -> str:
    """The section."""
    return section(
        "Which effect explains it" if diagnosis.verdict.where else "What each effect would explain",
        paragraph(_introduction(diagnosis)),
        _ranking_table(diagnosis),
        _linear_model(diagnosis),
        facts(_remarks(diagnosis)),
    )


def _introduction(diagnosis: Diagnosis) -> str:
    beside = " An effect that gains nothing beside the named causes is not needed." if diagnosis.verdict.acting else ""
    return (
        "Every effect of the simulator was tried, alone and in sets of two and three. The gain is the natural "
        "logarithm of how many times more probable the recordings are with the effect than with the simulator as it "
        "is, over all its sizes. The right effect also explains the deviations, and leaves nothing to gain for the "
        f"others.{beside}"
    )


def _ranking_table(diagnosis: Diagnosis) -> str:
    ranked = diagnosis.ranking
    has_causes = bool(diagnosis.verdict.acting)
    small = {one.cause.effect.name for one in diagnosis.verdict.negligible}
    named = {cause.effect.name for cause in diagnosis.verdict.causes}
    tied = {name for cause in diagnosis.verdict.causes for name in cause.tied_with}
    most = max([one.gain for one in ranked] + [1.0])
    beside = ["gain beside the<br/>named causes"] * has_causes
    head = headings(["effect", "", "gain alone", *beside, "deviations<br/>explained", "best size", "group"], words=1)
    rows = []
    for one in ranked:
        mark = (
            " named"
            if one.name in named
            else " tied"
            if one.name in tied
            else " negligible"
            if one.name in small
            else ""
        )
        name = f"<b>{text(one.name)}</b>" if mark else text(one.name)
        group = one.group if one.group != one.name else ""
        numbers = _numbers(one, has_causes=has_causes)
        rows.append([span(f"{name}{quiet(mark)}", "word"), _bar(one.gain / most), fixed(one.gain, 1), *numbers, group])
    caption = (
        "The effects, largest gain first, each taken alone. Deviations explained: the share that it takes away, below "
        "0 where it adds to them. Best size: the one that fits best alone. Effects of one group are easily mistaken "
        "for each other."
    )
    return table(caption, head, rows, words=1)


def _numbers(one: Ranked, *, has_causes: bool) -> list[str]:
    beside = ["" if one.gain_with_causes is None else fixed(one.gain_with_causes, 1)] * has_causes
    takes_away = "–" if one.takes_away is None else percent(one.takes_away)
    return [*beside, takes_away, size(one.value, one.unit)]


def _bar(share: float) -> str:
    """A gain as a length."""
    share = max(share, 0.0) if isfinite(share) else 0.0
    long = 120.0 * share
    return (
        f'<svg class="track" viewBox="0 0 128 16" role="img" aria-label="{percent(share)} of the best">'
        f'<path d="M4 8H124" stroke="var(--grid)" stroke-width="4"/>'
        f'<path d="M4 8H{4.0 + long:.1f}" stroke="var(--tuned)" stroke-width="6"/></svg>'
    )


def _linear_model(diagnosis: Diagnosis) -> str:
    linear = diagnosis.linear_model
    found = ""
    if linear.effect is not None:
        between = f"{number(linear.low)} to {number(linear.high)}"
        found = f": {text(linear.parameter)} {size(linear.value, linear.unit)} ({between})"
    return paragraph(
        f"<b>Check by a linear model: it {text(linear.says)}{found}.</b> It is a generalised least-squares "
        "regression of the rate error, with a bias that may walk at random. It uses neither the simulator nor the "
        "features, and knows only the effects that are linear. It leaves out what is too small to matter for yaw, such "
        "as 0.06 % of scale."
    )


def _remarks(diagnosis: Diagnosis) -> list[tuple[str, str]]:
    """What else is to be known of the candidates."""
    rows = [
        (f"Fits as well as {text(cause.effect.name)}", _tied(cause.tied_with)) for cause in diagnosis.verdict.causes
    ]
    alike = [f"{text(pair.first)} and {text(pair.second)} ({pair.cosine:.2f})" for pair in diagnosis.lookalikes[:PAIRS]]
    untestable = [f"{text(one.effect)}: {text(one.why)}" for one in diagnosis.untestable]
    return [
        *rows,
        ("Hard to tell apart here", f"{'; '.join(alike)} (cosine between what they do)" if alike else "no two"),
        ("Could not be tried", "; ".join(untestable) or "none"),
        ("Left out by --withhold", ", ".join(map(text, diagnosis.withheld)) or "none"),
    ]


def _tied(names: tuple[str, ...]) -> str:
    return ", ".join(map(text, names)) or "no other"
