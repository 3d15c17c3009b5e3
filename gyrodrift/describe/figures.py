"""Panels of a session as SVG elements of a page."""

from collections.abc import Sequence

from gyrodrift.describe.drawing import Panel
from gyrodrift.html.svg import as_svg, canvas, styled

WIDE_IN, HIGH_IN = 3.1, 1.9
FULL_WIDE_IN, FULL_HIGH_IN = 9.6, 2.9


def panel_svgs(panels: Sequence[Panel], name: str) -> list[str]:
    """Small charts of one size; `name` is unique within the page."""
    with styled():
        return [_svg(panel, f"{name}-{index}") for index, panel in enumerate(panels)]


def full_width_svg(panel: Panel, name: str) -> str:
    """A chart as wide as the page; `name` is unique within the page."""
    with styled():
        figure = canvas(FULL_WIDE_IN, FULL_HIGH_IN, inset=0.065, bottom=0.12, top=0.98, right=0.995)
        panel.draw(figure.add_subplot())
        return as_svg(figure, name, panel.name)


def _svg(panel: Panel, name: str) -> str:
    figure = canvas(WIDE_IN, HIGH_IN, inset=0.2, bottom=0.18, top=0.97, right=0.97)
    panel.draw(figure.add_subplot())
    return as_svg(figure, name, panel.name)
