"""The figures that were committed last, and what became worse since."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from evaluate.figures import Figure

LAST = Path(__file__).parent / "last.json"

SHARE_MARGIN = 0.05
"""A share may become worse by this, or by one case if that is more: rounding of another machine may turn one case."""

MEAN_MARGIN = 0.1
"""A mean may become worse by this part of itself: on another machine, single sessions end a little elsewhere."""


@dataclass(frozen=True, slots=True)
class Measured:
    """Figures of one part: the day they were made, and of which seed and how many cases (of each kind)."""

    made: str
    seed: int
    count: int
    figures: tuple[Figure, ...]


def read_last(path: Path = LAST) -> dict[str, Measured]:
    """By part; empty without a file."""
    parts = json.loads(path.read_text()) if path.is_file() else {}
    return {
        name: Measured(**(part | {"figures": tuple(Figure(**figure) for figure in part["figures"])}))
        for name, part in parts.items()
    }


def write_last(parts: Mapping[str, Measured], path: Path = LAST) -> None:
    """All parts, those that were not measured again included; a line for each figure, for `git diff`."""
    texts = [f"{json.dumps(name)}: {_text_of(parts[name])}" for name in sorted(parts)]
    path.write_text("{" + ",\n".join(texts) + "}\n")


def _text_of(part: Measured) -> str:
    head = json.dumps(asdict(part) | {"figures": None}, ensure_ascii=False)
    lines = ",\n".join(json.dumps(asdict(figure), ensure_ascii=False) for figure in part.figures)
    return head.replace("null", f"[\n{lines}\n]")


def worse_than(last: Measured, now: Measured) -> list[str]:
    """Names of figures that are worse by more than the margin, or gone; none where other cases were drawn."""
    if (last.seed, last.count) != (now.seed, now.count):
        return []
    by_name = {figure.name: figure for figure in now.figures}
    return [before.name for before in last.figures if is_worse(before, by_name.get(before.name))]


def is_worse(before: Figure, now: Figure | None) -> bool:
    """Whether a figure is worse than before by more than its margin; one that is gone is."""
    if now is None:
        return True
    lost = now.value - before.value if before.is_less_better else before.value - now.value
    return lost > margin_of(before) + 1e-9


def margin_of(before: Figure) -> float:
    """By how much a figure may become worse, in its own unit."""
    return max(SHARE_MARGIN, 1.0 / before.count) if before.is_share else MEAN_MARGIN * before.value


def table(now: Measured, last: Measured | None) -> list[str]:
    """A line for each figure: value, interval, count, and the last one where the same cases were drawn."""
    same = last is not None and (last.seed, last.count) == (now.seed, now.count)
    before = {figure.name: figure for figure in last.figures} if last is not None and same else {}
    width = max(len(figure.name) for figure in now.figures)
    return [_line(figure, before.get(figure.name), width) for figure in now.figures]


def _line(figure: Figure, before: Figure | None, width: int) -> str:
    interval = f"({_text(figure, figure.low)} to {_text(figure, figure.high)})"
    line = f"{figure.name:{width}}  {_text(figure, figure.value):>8}  {interval:20} of {figure.count:4}"
    if before is None:
        return line
    return f"{line}  last {_text(before, before.value)}{'  WORSE' if is_worse(before, figure) else ''}"


def _text(figure: Figure, value: float) -> str:
    return f"{100.0 * value:.0f} %" if figure.is_share else f"{value:.3g}"


def all_worse(last: Mapping[str, Measured], now: Mapping[str, Measured]) -> Sequence[str]:
    """`part: figure` of every part that was measured."""
    return [f"{name}: {figure}" for name in now if name in last for figure in worse_than(last[name], now[name])]
