"""The view of `gyrodrift top`: values, a chart of yaw, the horizon, the health of the service, and its clients."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, isfinite, radians, sin
from typing import NamedTuple

from rich.console import Group, RenderableType
from rich.panel import Panel
from rich.table import Table
from rich.text import Text

from gyrodrift.io.text_chart import DOTS, SMALLEST_ROWS, AxisRange, ChartLine, chart, legend, padded_range
from gyrodrift.outputs.fields import Field, Use, fields_of
from gyrodrift.outputs.health import HealthLevel, health
from gyrodrift.outputs.status import FilterStatus, LinkStatus, OutputStatus, ServiceStatus, aid_text


@dataclass(frozen=True, slots=True)
class Figure:
    """A labeled value; `says` is the value with its unit, or a dash if it is unknown."""

    label: str
    says: str


UNKNOWN = "–"


def figures(status: ServiceStatus) -> list[Figure]:
    """Values in order of importance."""
    return [*_filter_figures(status.filter), *_link_figures(status.link)]


def _filter_figures(now: FilterStatus) -> list[Figure]:
    rest = UNKNOWN if now.rest_probability is None else f"{now.rest_probability:.0%}"
    heading = [Figure("Heading", f"{now.heading_deg:.1f}°")] if now.heading_deg is not None else []
    scale = [Figure("Sigma of scale", f"{now.scale_sigma_deg:.2f} deg")] if now.scale_sigma_deg is not None else []
    return [
        Figure("Yaw", f"{now.yaw_deg:+z.2f}{_margin(now.yaw_sigma_deg, 2)} deg"),
        *scale,
        *heading,
        *_device_figures(now),
        *_tilt_figures(now),
        Figure("Bias", f"{now.bias_dps:+z.4f}{_margin(now.bias_sigma_dps, 4)} deg/s"),
        Figure("At rest", rest),
        *(_figure(field, getattr(now, field.name)) for field in fields_of(Use.FIGURE)),
        *(Figure(name, aid_text(aid)) for name, aid in (now.aids or {}).items()),
    ]


def _figure(field: Field, value: float | None) -> Figure:
    """Line of a field by its record."""
    return Figure(field.title, UNKNOWN if value is None else f"{value:.{field.shown}f} {field.unit}".rstrip())


def _device_figures(now: FilterStatus) -> list[Figure]:
    """Yaw of the device's own filter; no figures for a device without one."""
    if now.device_yaw_deg is None or now.device_difference_deg is None:
        return []
    return [
        Figure("Device yaw", f"{now.device_yaw_deg:+z.2f}{_margin(now.device_yaw_sigma_deg, 2)} deg"),
        Figure("Difference", f"{now.device_difference_deg:+z.2f} deg"),
    ]


def _tilt_figures(now: FilterStatus) -> list[Figure]:
    """Attitude of a device with three axes; no figures for one axis."""
    if now.roll_deg is None or now.pitch_deg is None or now.tilt_deg is None:
        return []
    return [
        Figure("Roll", f"{now.roll_deg:+z.1f} deg{_side(now.roll_deg, 'right side down', 'left side down')}"),
        Figure("Pitch", f"{now.pitch_deg:+z.1f} deg{_side(now.pitch_deg, 'nose down', 'nose up')}"),
        Figure("Tilt", f"{now.tilt_deg:z.1f}{_margin(now.tilt_sigma_deg, 2)} deg"),
    ]


def _side(angle_deg: float, positive: str, negative: str) -> str:
    """Direction of an angle that is not shown as 0."""
    return "" if round(angle_deg, 1) == 0.0 else f", {positive if angle_deg > 0.0 else negative}"


def _link_figures(now: LinkStatus) -> list[Figure]:
    return [
        Figure("Sample rate", f"{now.rate_hz:.1f} Hz"),
        Figure("Jitter", f"{now.jitter_ms:.1f} ms"),
        Figure("Samples", f"{now.samples}"),
        Figure("Gaps", f"{now.gaps} ({now.missing} samples)" if now.gaps else "0"),
        Figure("Damaged frames", f"{now.damaged}"),
    ]


def _margin(sigma: float | None, digits: int) -> str:
    """Standard deviation behind a value; empty if unknown."""
    return "" if sigma is None else f" ± {sigma:.{digits}f}"


SHOWN_PITCH_DEG = 45.0
"""Pitch that moves the horizon to the edge, deg."""

GROUND, MARK = "yellow", "bold"
WING = 3
"""Characters of the mark of the device on each side."""


def horizon(roll_deg: float, pitch_deg: float, rows: int) -> list[Text]:
    """Rows of text; two columns a row make it square.

    Roll is positive with the right side down, pitch with the nose down.
    """
    columns = 2 * rows
    return [_row(row, rows, columns, radians(roll_deg), pitch_deg) for row in range(rows)]


def _row(row: int, rows: int, columns: int, roll_rad: float, pitch_deg: float) -> Text:
    text = Text("".join(_cell(column, row, rows, columns, roll_rad, pitch_deg) for column in range(columns)), GROUND)
    if row == rows // 2:
        middle = columns // 2
        text = Text.assemble(text[: middle - WING], ("─" * WING + "┼" + "─" * (WING - 1), MARK), text[middle + WING :])
    return text


def _cell(column: int, row: int, rows: int, columns: int, roll_rad: float, pitch_deg: float) -> str:
    """Character with the dots that are ground."""
    bits = 0
    for dot_row, line in enumerate(DOTS):
        for dot_column, bit in enumerate(line):
            x = 2 * column + dot_column + 0.5 - columns
            y = 2 * rows - (4 * row + dot_row + 0.5)
            height = (y * cos(roll_rad) - x * sin(roll_rad)) / (2 * rows)
            bits |= bit if height < pitch_deg / SHOWN_PITCH_DEG else 0
    return chr(0x2800 + bits) if bits else " "


BLOCKS = "▁▂▃▄▅▆▇█"
FLAT_DEG = 0.1
"""A smaller range of yaw is noise and fills the lowest block alone, deg."""

LEAST_DEG = 1.0
"""The chart shows at least this range of yaw, deg."""

SPARKS = 60
MOST_HORIZON_ROWS, HORIZON_GAP = 9, 2
FRAME_COLUMNS, FRAME_ROWS = 4, 2
COLORS = {HealthLevel.GOOD: "green", HealthLevel.NOTE: "yellow", HealthLevel.BAD: "red"}
MOST_CLIENTS = 8
KEYS = "z zero   p pause   q quit"


class YawPoint(NamedTuple):
    """Yaw and its sigma at a time on the monotonic clock of the view, s and deg; NaN for a filter without a sigma."""

    t_s: float
    yaw_deg: float
    sigma_deg: float


def draw(
    status: ServiceStatus, points: Sequence[YawPoint], note: str = "", size: tuple[int, int] | None = None
) -> RenderableType:
    """The view of this moment.

    Parameters
    ----------
    points
        Yaw of the last minutes, oldest first.
    note
        Result of the last key.
    size
        Columns and rows of the terminal, which the view fills; None for as many rows as there are lines.
    """
    lines: list[RenderableType] = [_values(status), Text()]
    words = [Text(f"● {item.says}", COLORS[item.level]) for item in health(status)]
    clients = _outputs(status.outputs)
    foot = Text(f"{KEYS}   {note}", "dim", no_wrap=True, overflow="ellipsis")
    tail: list[RenderableType] = [*words]
    if clients is not None:
        tail += [Text(), clients]
    tail += [Text(), foot]
    title = f"gyrodrift {status.version} on {status.link.port or 'no port'}"
    rows = 0
    if size is not None:
        client_rows = 1 + (clients.row_count + 1 if clients is not None else 0)
        used = FRAME_ROWS + (len(figures(status)) + 1) // 2 + 1 + len(words) + client_rows + 2
        rows = size[1] - used - 1
    if size is None or rows < SMALLEST_ROWS + 1:
        line = Text.assemble(("Yaw  ", "dim"), (sparkline([point.yaw_deg for point in points][-SPARKS:]), "cyan"))
        return Panel(Group(*lines, line, Text(), *tail), title=title, height=size[1] if size else None)
    plot = _plot(status.filter, points, size[0] - FRAME_COLUMNS, rows)
    return Panel(Group(*lines, plot, Text(), *tail), title=title, height=size[1])


def state_of(status: ServiceStatus) -> RenderableType:
    """The state as lines for a pipe, without frame, chart and keys."""
    title = Text(f"gyrodrift {status.version} on {status.link.port or 'no port'}")
    words = [Text(f"● {item.says}") for item in health(status)]
    clients = _outputs(status.outputs)
    return Group(title, _values(status), *words, *([] if clients is None else [clients]))


def _values(status: ServiceStatus) -> Table:
    """Values in two columns."""
    values = figures(status)
    half = (len(values) + 1) // 2
    table = Table(box=None, show_header=False, pad_edge=False, padding=(0, 3, 0, 0))
    for first, second in zip(values[:half], [*values[half:], None], strict=False):
        second_cells = (second.label, second.says) if second else ("", "")
        table.add_row(first.label, Text(first.says, "bold"), *second_cells)
    return table


def _plot(now: FilterStatus, points: Sequence[YawPoint], columns: int, rows: int) -> RenderableType:
    """The chart, and beside it the horizon of a device with three axes."""
    if now.roll_deg is None or now.pitch_deg is None:
        return Group(*_chart(points, columns, rows))
    horizon_rows = min(rows, MOST_HORIZON_ROWS)
    grid = Table.grid(padding=(0, HORIZON_GAP, 0, 0))
    chart_columns = columns - 2 * horizon_rows - 2 * HORIZON_GAP
    picture = horizon(now.roll_deg, now.pitch_deg, horizon_rows)
    grid.add_row(Group(*_chart(points, chart_columns, rows)), Group(*picture))
    return grid


def _chart(points: Sequence[YawPoint], columns: int, rows: int) -> list[Text]:
    """Yaw against seconds before now, between its limits of two sigma."""
    now_s = points[-1].t_s if points else 0.0
    with_sigma = [point for point in points if isfinite(point.sigma_deg)]
    bounds = [
        ChartLine(
            name, [(p.t_s - now_s, p.yaw_deg + sign * 2.0 * p.sigma_deg) for p in with_sigma], "blue", is_dashed=True
        )
        for name, sign in (("± 2 sigma", 1.0), ("", -1.0))
    ]
    yaw = ChartLine("yaw", [(point.t_s - now_s, point.yaw_deg) for point in points], "cyan")
    series = [*bounds, yaw]
    values = [value for line in series for _, value in line.points]
    since_s = min(-10.0, points[0].t_s - now_s) if points else -10.0
    lines = chart(series, AxisRange(since_s, 0.0), padded_range(values, LEAST_DEG), columns, rows - 1)
    return [legend([yaw, *bounds[:1]] if with_sigma else [yaw], "deg against s before now:"), *lines]


def sparkline(values: Sequence[float]) -> str:
    """One block per value; the smallest value has the lowest block."""
    if not values:
        return ""
    least, most = min(values), max(values)
    span = max(most - least, FLAT_DEG)
    return "".join(BLOCKS[min(len(BLOCKS) - 1, int((value - least) / span * len(BLOCKS)))] for value in values)


def _outputs(outputs: Sequence[OutputStatus]) -> Table | None:
    """Table of outputs and their clients; None without outputs."""
    if not outputs:
        return None
    table = Table(box=None, pad_edge=False, padding=(0, 3, 0, 0), title_justify="left")
    for name in ("output", "address", "clients", "sent", "dropped"):
        table.add_column(name, justify="left" if name in ("output", "address") else "right")
    for output in outputs:
        counts = (str(output.client_count), str(output.sent), str(output.dropped))
        table.add_row(output.output, output.address or "not open", *counts)
        for client in output.clients[:MOST_CLIENTS]:
            table.add_row("", Text(client.peer, "dim"), "", str(client.sent), str(client.dropped))
        if output.client_count > MOST_CLIENTS:
            table.add_row("", Text(f"and {output.client_count - MOST_CLIENTS} more", "dim"))
    return table
