"""Reading a page as a person does, for tests of what it says."""

import json
import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any
from xml.etree import ElementTree as ET

from gyrodrift.report import page
from gyrodrift.report.chart import Chart

BLOCKS = '{% import "report/templates/blocks.html" as blocks %}'


@dataclass(frozen=True, slots=True)
class Written(page.Section):
    """A part of a page whose template is its own text."""

    def __html__(self) -> str:
        return page._environment().from_string(BLOCKS + self.template).render(self.values)


def shown(template: str, heading: str = "", **values: object) -> Written:
    """A part of a page from the text of a template, in which `blocks` are those of the reports."""
    return Written(template, values, heading)


def charts(html: str) -> list[dict[str, Any]]:
    """The charts of a page as data: series have their coordinates, not numbers of arrays."""
    return [drawn(str(item.get("data-chart"))) for item in parsed(html).iter("div") if item.get("class") == "chart"]


def drawn(content: Chart | str) -> dict[str, Any]:
    """A chart as data."""
    chart = dict(json.loads(content.json() if isinstance(content, Chart) else content))
    for series in series_of(chart):
        series |= {name: chart["arrays"][series[name]] for name in ("x", "y", "xEnd", "yEnd") if name in series}
    return chart


def series_of(chart: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """Series of all parts of a chart."""
    for part in chart["parts"]:
        yield from part["series"]


def parsed(html: str) -> ET.Element:
    """The page as XML, which it is after its first line: every element closed, everything escaped."""
    first, _, rest = html.partition("\n")
    assert first == "<!DOCTYPE html>"
    return ET.fromstring(rest)


def words(html: str) -> str:
    body = parsed(html).find("body")
    assert body is not None
    return re.sub(r"\s+", " ", " ".join(body.itertext()))


def row(html: str, name: str) -> list[str]:
    """The cells of the first row with this name."""
    rows = [["".join(cell.itertext()).strip() for cell in item] for item in parsed(html).iter("tr")]
    return next(cells for cells in rows if cells and cells[0] == name)
