"""The score as text: a table for the terminal, Markdown for docs/results.md, JSON for programs."""

from dataclasses import asdict
from typing import Any

from gyrogap.chance import wilson

from blind.score import Score, Share


def terminal_text(score: Score) -> str:
    """Rows, figures, reliability, misses."""
    rows = [_cells(share) for share in score.shares]
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    lines = ["  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows]
    lines += ["", *(f"{what}: {value}" for what, value in _figures(score)), "", *_reliability(score)]
    for share in score.shares:
        if share.misses:
            lines += ["", f"misses of: {share.what}", *(f"  {miss}" for miss in share.misses)]
    return "\n".join(lines) + "\n"


def markdown(score: Score) -> str:
    """The table of docs/results.md, the reliability table and the list of misses."""
    lines = ["| | goal | result | | Wilson 95 % |", "|---|---|---|---|---|"]
    lines += [
        f"| {what} | {goal} | {result} | {cases} | {interval} |"
        for what, goal, result, cases, interval in map(_cells, score.shares)
    ]
    lines += [f"| {what} | | {value} | | |" for what, value in _figures(score)]
    lines += ["", "| stated probability | mean | came true | Wilson 95 % |", "|---|---|---|---|"]
    lines += [
        f"| {each.low:g} to {each.high:g} | {each.mean:.2f} | {each.hits} of {each.total} "
        f"| {_interval(each.hits, each.total)} |"
        for each in score.bins
    ]
    for share in score.shares:
        if share.misses:
            lines += ["", f"Misses of “{share.what}”:", "", *(f"- {miss}" for miss in share.misses)]
    return "\n".join(lines) + "\n"


def as_json(score: Score) -> dict[str, Any]:
    """Everything, with the intervals."""
    shares = [
        asdict(share) | {"share": share.share, "wilson_95": wilson(share.hits, share.total)} for share in score.shares
    ]
    return asdict(score) | {"shares": shares}


def _cells(share: Share) -> tuple[str, str, str, str, str]:
    goal = "" if share.goal is None else f"{'≤' if share.is_most else '≥'} {100.0 * share.goal:.0f} %"
    if not share.total:
        return share.what, goal, "not tried", "", ""
    result = f"{100.0 * share.share:.1f} %"
    return share.what, goal, result, f"{share.hits} of {share.total}", _interval(share.hits, share.total)


def _interval(hits: int, total: int) -> str:
    low, high = wilson(hits, total)
    return f"{100.0 * low:.0f} to {100.0 * high:.0f} %"


def _figures(score: Score) -> list[tuple[str, str]]:
    ratio = "not tried" if score.shrink_ratio is None else f"{score.shrink_ratio:.2f} (goal ≥ 0.9)"
    return [
        (f"shrink against the oracle, median of {score.shrink_ratio_cases}", ratio),
        ("Brier score of the stated probabilities", "none stated" if score.brier is None else f"{score.brier:.3f}"),
        ("seconds for a case, median and longest", f"{score.median_s:.0f} and {score.longest_s:.0f}"),
        ("runs that failed", str(score.failures)),
    ]


def _reliability(score: Score) -> list[str]:
    return ["stated probability, its mean, how many came true"] + [
        f"  {each.low:g} to {each.high:g}  {each.mean:.2f}  {each.hits} of {each.total} "
        f"({_interval(each.hits, each.total)})"
        for each in score.bins
    ]
