"""The panels of a session as figures of a page, small multiples of one size."""

from collections.abc import Sequence

from gyrodrift.describe.panels import Panel
from gyrodrift.html.svg import as_svg, canvas, styled

WIDE_IN, HIGH_IN = 3.1, 1.9


def panel_svgs(drawn: Sequence[Panel], name: str) -> list[str]:
    """Of each panel an element; `name` is that of no other figure of the page."""
    with styled():
        return [_svg(panel, f"{name}-{at}") for at, panel in enumerate(drawn)]


def _svg(panel: Panel, name: str) -> str:
    figure = canvas(WIDE_IN, HIGH_IN, left=0.2, bottom=0.18, top=0.97, right=0.97)
    panel.draw(figure.add_subplot())
    return as_svg(figure, name, panel.name)
