"""A page of sections: one HTML file with style sheet, scripts and charts inside, and nothing from the network."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from unicodedata import category

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from gyrodrift.report.numbers import degrees, minus, significant
from gyrodrift.values.words import counted

PACKAGE = Path(__file__).parents[1]
HOME = Path(__file__).parent
UPLOT = PACKAGE / "outputs" / "web" / "page" / "uplot"
"""uPlot draws the charts of reports and of the live page."""

POLICY = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:"
"""Content security policy: the page has everything inside, and fetches nothing."""

CHAPTERS = 3
"""Least number of chapters that get a table of contents."""

FORBIDDEN = ("Cc", "Cs", "Cn")
"""Unicode categories: control characters, surrogates, and unassigned code points."""


@dataclass(frozen=True, slots=True)
class Section:
    """A part of a page: its template, and the values that the template shows.

    template
        Path within the package `gyrodrift`.
    heading
        Heading of a chapter, unique within the page; empty for the head of a page.
    is_folded
        Whether only the heading is shown at first.
    """

    template: str
    values: Mapping[str, object] = field(default_factory=dict)
    heading: str = ""
    is_folded: bool = False

    @property
    def anchor(self) -> str:
        """Name of the chapter in links."""
        return re.sub(r"[^a-z0-9]+", "-", self.heading.lower()).strip("-")

    def __html__(self) -> str:
        """The part without its heading."""
        return _environment().get_template(self.template).render(self.values)


def page(title: str, sections: Sequence[Section | None]) -> str:
    """HTML of a whole page; a section that is None is left out."""
    parts = [(section, Markup(section)) for section in sections if section is not None]  # noqa: S704 - of a template
    chapters = [section for section, _ in parts if section.heading]
    has_charts = any('data-chart="' in html for _, html in parts)
    base = _environment().get_template("report/templates/base.html")
    html = base.render(
        title=title,
        policy=POLICY,
        styles=[_source(HOME / "page.css"), *[_source(UPLOT / "uPlot.min.css")] * has_charts],
        scripts=[_uplot(), _source(HOME / "chart.js")] * has_charts,
        contents=chapters if len(chapters) >= CHAPTERS else [],
        parts=parts,
    )
    return _allowed(html)


def _source(path: Path) -> Markup:
    return Markup(path.read_text(encoding="utf-8"))  # noqa: S704 - a file of this package


def _uplot() -> Markup:
    """The script with its license instead of its first line, which is an address."""
    code = _source(UPLOT / "uPlot.iife.min.js").partition("\n")[2]
    return Markup("/*! uPlot\n{}*/\n{}").format(_source(UPLOT / "LICENSE"), code)


@cache
def _environment() -> Environment:
    made = Environment(
        loader=FileSystemLoader(PACKAGE),
        autoescape=True,
        undefined=StrictUndefined,
        extensions=["jinja2.ext.do"],
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.filters |= {"significant": significant, "degrees": degrees, "counted": counted, "minus": minus}
    made.filters["unbroken"] = unbroken
    return made


def _allowed(html: str) -> str:
    """HTML in which forbidden characters, such as escape codes in a name, are replaced."""
    forbidden = [letter for letter in set(html) - set("\n\t") if category(letter) in FORBIDDEN]
    return html.translate(dict.fromkeys(map(ord, forbidden), "\ufffd"))


def macro(template: str, name: str) -> Callable[..., Markup]:
    """A macro of a template as a function."""
    function: Callable[..., Markup] = getattr(_environment().get_template(template).module, name)
    return function


UNIT = re.compile(r"\S*\d[\d.,]* (?:deg/s²|deg/s|°/h|deg|ms|min|s|h|Hz|ppm|%|°C|σ)(?![\w/])[^\s\w]*")
"""A number with its unit, and with the signs around both."""


def unbroken(words: str) -> Markup:
    """Text that breaks between no number and its unit."""
    text, end = Markup(), 0
    for match in UNIT.finditer(words):
        text += Markup("{}{}").format(words[end : match.start()], marked("word", match[0]))
        end = match.end()
    return text + words[end:]


def marked(kind: str, words: object) -> Markup:
    """Text in a span with a class of the style sheet."""
    return Markup('<span class="{}">{}</span>').format(kind, words)


def bold(words: object) -> Markup:
    """Bold text."""
    return Markup("<b>{}</b>").format(words)


def code(words: object) -> Markup:
    """Text as code."""
    return Markup("<code>{}</code>").format(words)


def titled(name: str, note: object, number: str = "") -> Markup:
    """Name of a chart after its number, in full under the pointer, with a note."""
    return Markup('<b title="{}">{}{}</b>{}').format(name, number, name, marked("note", note))
