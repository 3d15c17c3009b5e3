"""Reading a page as a person does, for tests of what it says."""

import re
from xml.etree import ElementTree as ET


def parsed(html: str) -> ET.Element:
    """The page as XML, which it is after its first line: every element closed, everything escaped."""
    first, _, rest = html.partition("\n")
    assert first == "<!DOCTYPE html>"
    return ET.fromstring(rest)


def words(html: str) -> str:
    """What a reader reads, the figures' words too."""
    body = parsed(html).find("body")
    assert body is not None
    return re.sub(r"\s+", " ", " ".join(body.itertext()))


def row(html: str, name: str) -> list[str]:
    """The cells of the first row with this name."""
    rows = [["".join(cell.itertext()).strip() for cell in one] for one in parsed(html).iter("tr")]
    return next(cells for cells in rows if cells and cells[0] == name)
