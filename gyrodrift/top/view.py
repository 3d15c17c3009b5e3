"""The view of `gyrodrift top`: values, a chart of yaw, the horizon, the health of the service, and its clients."""

from collections.abc import Sequence
from math import isfinite
from typing import NamedTuple

from rich.console import Group, RenderableType
from rich.panel import Panel
from rich.table import Table
from rich.text import Text

from gyrodrift.io.text_chart import SMALLEST_ROWS, AxisRange, ChartLine, chart, legend, padded_range
from gyrodrift.outputs.health import HealthLevel, health
from gyrodrift.outputs.status import FilterStatus, OutputStatus, ServiceStatus
from gyrodrift.top.figures import figures
from gyrodrift.top.horizon import horizon

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
