"""The comparison chart of the README, drawn from the tables of docs/results: no figure is stated a second time."""

import csv
from dataclasses import dataclass
from math import log10
from pathlib import Path

from pictures.card import card, label, line

RESULTS = Path(__file__).parents[2] / "docs" / "results" / "0.1.0"
REAL, HARD = RESULTS / "all-methods.csv", RESULTS / "hard-cases-defaults.csv"

METHODS = ("Euler", "start calibration", "x-io Fusion", "VQF", "restlevel")
TITLES = {
    "few-rests": "turntable, almost no rests",
    "turntable": "turntable with rests",
    "spin-0.5": "constant spin of 0.5°/s",
    "spin-1.5": "constant spin of 1.5°/s",
    "spin-20": "constant spin of 20°/s",
    "bias-3": "bias of 3°/s",
    "scale-1": "scale error of 1 %",
    "warmup": "fast warm-up",
    "temperature": "temperature cycle",
    "drive": "drive in long gentle curves",
    "random-walk": "bias that walks",
    "drops": "lost samples",
}
"""Names of the hard cases in words."""

METHODS_IN_WORDS = ("plain integration", "start calibration", "x-io Fusion", "VQF", "gyrodrift")

LEAST_DEG, LARGEST_DEG = 0.003, 30000.0
WIDTH, ROW, TOP, NAMES = 860, 21.0, 104.0, 200.0
PANEL = 300.0
"""Width of a panel, px."""

LEFTS = (NAMES, NAMES + PANEL + 30.0)
"""Where the panels begin, px."""

STYLE = """
.tint { fill: var(--tint) }
.start { stroke: var(--muted); stroke-width: 2; fill: none }
.fusion { fill: var(--green) } .vqf { fill: none; stroke: var(--violet); stroke-width: 2 } .ours { fill: var(--ours) }
"""


@dataclass(frozen=True, slots=True)
class Row:
    """Mean absolute yaw error of each method on one recording or case, deg."""

    name: str
    errors_deg: dict[str, float]

    @property
    def is_lost(self) -> bool:
        """Whether another method of the chart is better than restlevel."""
        return self.errors_deg["restlevel"] > min(self.errors_deg.values())


def rows_of(path: Path, column: int = 0) -> list[Row]:
    """Rows of a table with one of the errors that a cell holds as `still / moving`."""
    with path.open(encoding="utf-8", newline="") as table:
        return [
            Row(_title(name), {method: float(cells[method].split(" / ")[column]) for method in METHODS})
            for cells in csv.DictReader(table)
            if not (name := next(iter(cells.values()))).startswith("mean")
        ]


def _title(name: str) -> str:
    return TITLES.get(name, name)


def write(path: Path) -> None:
    """Write the chart of the committed tables."""
    path.write_text(picture(), encoding="utf-8")


def picture() -> str:
    """The chart of the committed tables."""
    return draw(rows_of(REAL), rows_of(HARD), rows_of(HARD, 1))


def draw(real: list[Row], still: list[Row], moving: list[Row]) -> str:
    """The chart: real recordings above, hard cases below, at rest first and moving from the first sample on."""
    hard_top = TOP + ROW * len(real) + 62
    height = hard_top + ROW * len(still) + 44
    content = (
        label(24, 34, "Mean yaw error in degrees, everything at its defaults", "title")
        + _legend()
        + label(NAMES, TOP - 10, "real recordings", "bold")
        + _panel(real, LEFTS[0], TOP)
        + _names(real, TOP)
        + _note()
        + label(LEFTS[0], hard_top - 10, "hard cases, at rest first", "bold")
        + label(LEFTS[1], hard_top - 10, "the same, moving from the first sample", "bold")
        + _names(still, hard_top)
        + _panel(still, LEFTS[0], hard_top)
        + _panel(moving, LEFTS[1], hard_top)
    )
    return card(WIDTH, round(height), "Mean yaw error of five methods; docs/results has the tables", STYLE, content)


def _x(left: float, error_deg: float) -> float:
    share = log10(max(error_deg, LEAST_DEG) / LEAST_DEG) / log10(LARGEST_DEG / LEAST_DEG)
    return left + PANEL * share


def _panel(rows: list[Row], left: float, top: float) -> str:
    bottom = top + ROW * len(rows)
    tints = "".join(
        f'<rect x="{left:g}" y="{top + ROW * index:g}" width="{PANEL:g}" height="{ROW:g}" class="tint"/>\n'
        for index, row in enumerate(rows)
        if row.is_lost
    )
    decades = ((0.01, "0.01°"), (0.1, "0.1"), (1.0, "1"), (10.0, "10"), (100.0, "100"), (1000.0, "1000"), (1e4, "10⁴"))
    grid = "".join(
        line(_x(left, value), top, _x(left, value), bottom, "grid")
        + label(_x(left, value), bottom + 16, text, "small muted middle")
        for value, text in decades
    )
    marks = "".join(
        _mark(name, _x(left, row.errors_deg[name]), top + ROW * (index + 0.5))
        for index, row in enumerate(rows)
        for name in METHODS
    )
    return tints + grid + line(left, bottom, left + PANEL, bottom, "axis") + marks


def _names(rows: list[Row], top: float) -> str:
    return "".join(label(NAMES - 12, top + ROW * (i + 0.5) + 4, row.name, "small end") for i, row in enumerate(rows))


def _mark(method: str, x: float, y: float) -> str:
    match method:
        case "Euler":
            return f'<path d="M{x:.1f} {y - 7:.1f}v14" class="start"/>\n'
        case "start calibration":
            return f'<path d="M{x - 4:.1f} {y - 4:.1f}l8 8m0 -8l-8 8" class="start"/>\n'
        case "x-io Fusion":
            return f'<path d="M{x:.1f} {y - 5:.1f}l5 9h-10z" class="fusion"/>\n'
        case "VQF":
            return f'<rect x="{x - 4:.1f}" y="{y - 4:.1f}" width="8" height="8" class="vqf"/>\n'
        case _:
            return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="6" class="ours"/>\n'


def _legend() -> str:
    places = zip((24, 178, 336, 456, 534), METHODS, METHODS_IN_WORDS, strict=True)
    return "".join(
        _mark(method, x + 6, 56) + label(x + 20, 60, text, "bold" if text == "gyrodrift" else "")
        for x, method, text in places
    )


def _note() -> str:
    x, y = LEFTS[1], TOP + 16
    return (
        f'<rect x="{x:g}" y="{y - 12:g}" width="16" height="16" class="tint"/>\n'
        + label(x + 24, y, "another method is better than gyrodrift", "small")
        + label(x, y + 24, "Left is better. Each grid line is a factor of ten.", "small muted")
        + label(x, y + 44, "A real row is one recording. A hard case is", "small muted")
        + label(x, y + 60, "ten simulated sessions of ten minutes.", "small muted")
    )
