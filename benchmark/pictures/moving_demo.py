"""The demo as a picture that moves: the heading of plain integration drifts away, the heading of gyrodrift stays.

CSS animates it, so it plays inside an `<img>`. A reader who asks for less motion sees the last frame.
"""

import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from support import Command

from gyrodrift.evaluation.integration import trapezium
from pictures.card import card, label, line

CONFIG = Path(__file__).parents[2] / "config" / "gyrodrift.yaml"
DURATION_S = 60.0
LOOP_S = 12.0
PLAYED = 10.0 / LOOP_S
"""Share of the loop that plays; then the last frame stands."""

WIDTH, HEIGHT = 800, 310
CENTER_X, CENTER_Y, RADIUS = 150.0, 178.0, 92.0
LEFT, RIGHT, TOP, BOTTOM = 345.0, 700.0, 80.0, 255.0
LARGEST_DEG = 22.0
KEYFRAMES = 40
READINGS = 12
ROW = 24.0
"""Height of one reading in the column of readings that moves up, step by step."""

STYLE = f"""
.raw {{ stroke: var(--raw); fill: none; stroke-width: 2.5; stroke-dasharray: 7 4 }}
.ours {{ stroke: var(--ours); fill: none; stroke-width: 3.5 }}
.head {{ stroke-dasharray: none }}
.needle {{ transform-origin: {CENTER_X:g}px {CENTER_Y:g}px }}
.raw-text {{ fill: var(--raw); font-weight: 600 }} .ours-text {{ fill: var(--ours); font-weight: 600 }}
.table {{ fill: none; stroke: var(--edge); stroke-width: 2 }}
.cover {{ fill: var(--card); transform-origin: {RIGHT + 10:g}px 0; transform: scaleX(0) }}
"""


@dataclass(frozen=True, slots=True)
class DemoRun:
    """A run of the demo: device time in s and yaw errors against the encoder in deg, shape (n,)."""

    t_s: np.ndarray
    raw_deg: np.ndarray
    corrected_deg: np.ndarray

    def at(self, t_s: float) -> tuple[float, float]:
        """Errors of plain integration and of gyrodrift at a time, deg."""
        return float(np.interp(t_s, self.t_s, self.raw_deg)), float(np.interp(t_s, self.t_s, self.corrected_deg))


def run_of(lines: list[dict[str, Any]]) -> DemoRun:
    """Yaw errors of the lines that `serve` printed, up to the duration of the demo."""
    rows = [(row["t_s"], row["rate_dps"], row["yaw_deg"], row["encoder_deg"]) for row in lines]
    t_s, rate_dps, yaw_deg, encoder_deg = np.array(rows).T
    true_deg = encoder_deg - encoder_deg[0]
    raw_deg = trapezium(np.diff(t_s, prepend=t_s[0]), rate_dps)
    shown = t_s <= DURATION_S + 0.001
    return DemoRun(t_s[shown], (raw_deg - true_deg)[shown], (yaw_deg - true_deg)[shown])


def record_demo() -> DemoRun:
    """Run the device and the service of `gyrodrift demo` for a minute of device time."""
    with tempfile.TemporaryDirectory() as folder:
        port = Path(folder, "gyro")
        device_options = ("--link", port, "--quiet", "--wait", "--profile", "turntable", "--seed", "1", "--speed", "10")
        with Command(*device_options, module="firmware_sim") as device:
            device.until(lambda _: port.exists(), "port")
            with Command("serve", "--port", port, "--config", CONFIG) as serve:
                serve.until(lambda command: command.out.count("\n") > DURATION_S * 100, "samples")
                return run_of(serve.all_lines())


def x_of(t_s: float) -> float:
    """Horizontal place of a time in the chart."""
    return LEFT + (RIGHT - LEFT) * t_s / DURATION_S


def y_of(error_deg: float) -> float:
    """Vertical place of an error in the chart."""
    return BOTTOM - (BOTTOM - TOP) * error_deg / LARGEST_DEG


def write(path: Path) -> None:
    """Run the demo and write its picture."""
    path.write_text(draw(record_demo()), encoding="utf-8")


def draw(run: DemoRun) -> str:
    """The picture of a run."""
    title = (
        f"A minute on a simulated turntable. Plain integration ends {run.raw_deg[-1]:.1f} degrees off, "
        f"gyrodrift {run.corrected_deg[-1]:.2f} degrees."
    )
    content = (
        label(24, 34, "One minute on a turntable with the noise and bias of a 3-dollar gyro", "title")
        + _dial(run)
        + _chart(run)
        + label(
            WIDTH - 24, HEIGHT - 14, "recorded from <tspan font-family='monospace'>make demo</tspan>", "small muted end"
        )
    )
    return card(WIDTH, HEIGHT, title, STYLE + _motion(run), content)


def _dial(run: DemoRun) -> str:
    ticks = "".join(
        f'<path d="M{CENTER_X:g} {CENTER_Y - RADIUS:g}v8" class="axis"'
        f' transform="rotate({degrees} {CENTER_X:g} {CENTER_Y:g})"/>\n'
        for degrees in range(0, 360, 30)
    )
    return (
        label(CENTER_X, 66, "heading, seen from the table", "small muted middle")
        + f'<circle cx="{CENTER_X:g}" cy="{CENTER_Y:g}" r="{RADIUS:g}" class="table"/>\n{ticks}'
        + _needle("raw", run.raw_deg[-1])
        + _needle("ours", run.corrected_deg[-1])
        + f'<circle cx="{CENTER_X:g}" cy="{CENTER_Y:g}" r="5" style="fill: var(--ink)"/>\n'
    )


def _needle(name: str, error_deg: float) -> str:
    return (
        f'<g class="needle {name}-needle" style="transform: rotate({-error_deg:.2f}deg)">'
        f'<path class="{name}" d="M{CENTER_X:g} {CENTER_Y:g}V{CENTER_Y - RADIUS + 12:g}"/>'
        f'<path class="{name} head" d="M{CENTER_X - 6:g} {CENTER_Y - RADIUS + 24:g}l6 -12l6 12"/></g>\n'
    )


def _chart(run: DemoRun) -> str:
    grid = "".join(
        line(LEFT, y_of(degrees), RIGHT, y_of(degrees), "grid")
        + label(LEFT - 8, y_of(degrees) + 4, f"{degrees}°", "small muted end")
        for degrees in (5, 10, 15, 20)
    )
    zero = line(LEFT, BOTTOM, RIGHT, BOTTOM, "axis") + label(LEFT - 8, BOTTOM + 4, "0°", "small muted end")
    seconds = "".join(label(x_of(s), BOTTOM + 18, f"{s} s", "small muted middle") for s in (0, 20, 40, 60))
    curves = _curve(run.t_s, run.raw_deg, "raw") + _curve(run.t_s, run.corrected_deg, "ours")
    covered = f'x="{LEFT:g}" y="{TOP - 4:g}" width="{RIGHT - LEFT + 10:g}" height="{BOTTOM - TOP + 8:g}"'
    cover = f'<rect {covered} class="cover"/>\n'
    return (
        label(LEFT, 66, "yaw error against the encoder of the table", "small muted")
        + zero
        + curves
        + cover
        + grid
        + seconds
        + _readings(run)
    )


def _curve(t_s: np.ndarray, error_deg: np.ndarray, name: str) -> str:
    chosen = np.linspace(0, len(t_s) - 1, 241).round().astype(int)
    points = " ".join(f"{x_of(t_s[i]):.1f},{y_of(error_deg[i]):.1f}" for i in chosen)
    return f'<polyline class="{name}" points="{points}"/>\n'


def _readings(run: DemoRun) -> str:
    moments = np.linspace(0.0, DURATION_S, READINGS + 1)
    columns = zip(*(run.at(moment) for moment in moments), strict=True)
    return "".join(
        label(x, y - 22, name, f"small {css}-text")
        + f'<svg x="{x - 4:g}" y="{y - 18:g}" width="90" height="{ROW:g}"><g class="readings">'
        + "".join(
            label(4, 17 + ROW * row, f"{value:.2f}°".replace("-0.00", "0.00"), f"{css}-text")
            for row, value in enumerate(column)
        )
        + "</g></svg>\n"
        for (x, y, name, css), column in zip(
            ((RIGHT + 14, TOP + 34, "integrated", "raw"), (RIGHT + 14, BOTTOM - 8, "gyrodrift", "ours")),
            columns,
            strict=True,
        )
    )


def _motion(run: DemoRun) -> str:
    """Keyframes of needles, curves and readings; without them everything stands at the end of the minute."""
    moments = np.linspace(0.0, DURATION_S, KEYFRAMES + 1)
    angles = [run.at(moment) for moment in moments]
    needles = "".join(
        f"@keyframes {name} {{ {_frames([f'transform: rotate({-pair[column]:.2f}deg)' for pair in angles])} }}\n"
        for column, name in enumerate(("raw", "ours"))
    )
    rows = [f"transform: translateY({-ROW * row:g}px)" for row in range(READINGS + 1)]
    return (
        f".readings {{ {rows[-1]} }}\n"
        "@media (prefers-reduced-motion: no-preference) {\n"
        f"{needles}"
        f"@keyframes readings {{ {_frames(rows)} }}\n"
        f"@keyframes cover {{ 0% {{ transform: scaleX(1) }} {100 * PLAYED:.1f}%, 100% {{ transform: scaleX(0) }} }}\n"
        f".raw-needle {{ animation: raw {LOOP_S:g}s linear -{LOOP_S * PLAYED:g}s infinite }}\n"
        f".ours-needle {{ animation: ours {LOOP_S:g}s linear -{LOOP_S * PLAYED:g}s infinite }}\n"
        f".cover {{ animation: cover {LOOP_S:g}s linear -{LOOP_S * PLAYED:g}s infinite }}\n"
        f".readings {{ animation: readings {LOOP_S:g}s step-end -{LOOP_S * PLAYED:g}s infinite }}\n"
        "}\n"
    )


def _frames(values: list[str]) -> str:
    """Keyframes that are evenly spaced over the part of the loop that plays; the last one stays."""
    last = len(values) - 1
    shares = [f"{100 * PLAYED * index / last:.1f}%" for index in range(last)] + [f"{100 * PLAYED:.1f}%, 100%"]
    return " ".join(f"{share} {{ {value} }}" for share, value in zip(shares, values, strict=True))
