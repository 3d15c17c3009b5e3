"""Values below a heading, as in `Gyroscope:` followed by lines `X = 0.1`, `Y = 0.2` and `Z = 0.3`."""

import re

from gyrodrift.columns.names import kind_of
from gyrodrift.link.text.fields import Fields, Form, as_label, fields_of

HEADING = re.compile(r"[^A-Za-z0-9]*+([A-Za-z][\w ()\[\]/²°.^-]{0,60}?)\s*+(:?)[^A-Za-z0-9)\]]*+")
UNIT_NAMED = re.compile(r"\s{1,4}in\s{1,4}(\S{1,20})$")
"""`Gyroscope in degrees/second` names its unit."""


class Headings:
    """Fields of consecutive lines; labels of a single letter get the heading above them."""

    def __init__(self) -> None:
        self.heading = ""

    def fields_of(self, line: str) -> Fields | None:
        """Fields of the next line, with complete labels."""
        fields = fields_of(line)
        if fields is None:
            return None
        if fields.form is Form.LABELED:
            return fields._replace(labels=tuple(map(self.full, fields.labels)))
        if match := HEADING.fullmatch(line):
            name = as_label(UNIT_NAMED.sub(r" (\1)", match[1]))
            if match[2] or kind_of(f"{name} z"):
                self.heading = name
        return fields

    def full(self, label: str) -> str:
        """Label with its heading, if it is a single axis."""
        return f"{self.heading} {label}" if len(label) == 1 and self.heading else label
