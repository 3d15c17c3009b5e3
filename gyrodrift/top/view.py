"""What `gyrodrift top` shows: figures, a sparkline of yaw, how the service is in words, and who listens."""

from collections.abc import Sequence

from rich.console import Group, RenderableType
from rich.panel import Panel
from rich.table import Table
from rich.text import Text

from gyrodrift.outputs.health import HealthLevel, health
from gyrodrift.outputs.status import OutputStatus, ServiceStatus
from gyrodrift.outputs.words import figures

BLOCKS = "▁▂▃▄▅▆▇█"
FLAT_DEG = 0.1
"""A range that fills no more than the lowest block: noise is no motion."""

COLOURS = {HealthLevel.GOOD: "green", HealthLevel.NOTE: "yellow", HealthLevel.BAD: "red"}
MOST_CLIENTS = 8
KEYS = "z zero   p pause   q quit"


def draw(status: ServiceStatus, yaws_deg: Sequence[float], note: str = "") -> RenderableType:
    """The whole view; `yaws_deg` is yaw at equal times up to now, `note` what a key did last."""
    said = figures(status)
    half = (len(said) + 1) // 2
    table = Table(box=None, show_header=False, pad_edge=False, padding=(0, 3, 0, 0))
    for left, right in zip(said[:half], [*said[half:], None], strict=False):
        table.add_row(left.label, Text(left.says, "bold"), right.label if right else "", right.says if right else "")
    words = [Text(f"● {each.says}", COLOURS[each.level]) for each in health(status)]
    line = Text.assemble(("Yaw  ", "dim"), (sparkline(yaws_deg), "cyan"))
    foot = Text(f"{KEYS}   {note}", "dim")
    title = f"gyrodrift {status.version} on {status.link.port or 'no port'}"
    return Panel(Group(table, Text(), line, Text(), *words, *_outputs(status.outputs), Text(), foot), title=title)


def sparkline(values: Sequence[float]) -> str:
    """A block a value, from the least to the most of them."""
    if not values:
        return ""
    least, most = min(values), max(values)
    span = max(most - least, FLAT_DEG)
    return "".join(BLOCKS[min(len(BLOCKS) - 1, int((value - least) / span * len(BLOCKS)))] for value in values)


def _outputs(outputs: Sequence[OutputStatus]) -> list[RenderableType]:
    if not outputs:
        return []
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
    return [Text(), table]
