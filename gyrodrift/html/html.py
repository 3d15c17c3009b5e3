"""Reports as HTML in one file: style sheet and scripts are inside, and nothing comes from the network."""

import re
from collections.abc import Sequence
from html import escape
from pathlib import Path
from unicodedata import category

STYLE_SHEET = Path(__file__).with_name("page.css")
SCRIPTS = {"data-curve=": Path(__file__).with_name("page.js"), 'class="chart"': Path(__file__).with_name("chart.js")}
"""Scripts, by the mark of the elements that need them."""

POLICY = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:"
"""Content security policy: the page has everything inside, and fetches nothing."""

LISTED = 3
"""Least number of chapters that get a table of contents."""

CHAPTER = re.compile(r'<section id="([^"]+)">\n<h2>(.*?)</h2>')
HEADING = re.compile(r"<th[^>]*>(.*?)</th>", re.DOTALL)
TAG = re.compile(r"<[^>]*>")

NARROW = 4
"""Tables with more columns than this become lists on a narrow screen."""

FORBIDDEN = ("Cc", "Cs", "Cn")
"""Unicode categories: control characters, surrogates, and unassigned code points."""


def text(value: str) -> str:
    """Escape text for HTML; forbidden characters, such as escape codes in a name, are replaced."""
    return escape("".join(_allowed(letter) for letter in value))


def _allowed(letter: str) -> str:
    return "\ufffd" if category(letter) in FORBIDDEN and letter not in "\n\t" else letter


def page(title: str, body: Sequence[str]) -> str:
    """HTML of a whole page; `body` is its header and then its chapters."""
    style = STYLE_SHEET.read_text(encoding="utf-8")
    head, *chapters = body
    parts = "\n".join(part for part in (head, _contents(chapters), *chapters) if part)
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8"/>
<meta name="viewport" content="width=device-width, initial-scale=1"/>
<meta http-equiv="Content-Security-Policy" content="{POLICY}"/>
<title>{text(title)}</title>
<style>
{style}</style>
{_scripts(parts)}</head>
<body>
<main>
{parts}
</main>
</body>
</html>
"""


def _scripts(parts: str) -> str:
    """The scripts that some element of the page needs."""
    sources = [path.read_text(encoding="utf-8") for mark, path in SCRIPTS.items() if mark in parts]
    return "".join(f"<script>//<![CDATA[\n{source}//]]></script>\n" for source in sources)


def _contents(chapters: Sequence[str]) -> str:
    """Table of contents; empty for few chapters."""
    chapter_headings = CHAPTER.findall("\n".join(chapters))
    if len(chapter_headings) < LISTED:
        return ""
    inside = "".join(f'<li><a href="#{name}">{heading}</a></li>' for name, heading in chapter_headings)
    return f'<nav class="contents" aria-label="Contents"><ol>{inside}</ol></nav>'


def header(kicker: str, headline: str, *parts: str) -> str:
    """Header of a page: a small line, the headline, and HTML."""
    inside = "\n".join(parts)
    return f'<header>\n<p class="kicker">{text(kicker)}</p>\n<h1>{text(headline)}</h1>\n{inside}\n</header>'


def section(heading: str, *parts: str) -> str:
    """A chapter; its heading is unique within the page, because links use it."""
    inside = "\n".join(part for part in parts if part)
    name = re.sub(r"[^a-z0-9]+", "-", heading.lower()).strip("-")
    return f'<section id="{name}">\n<h2>{text(heading)}</h2>\n{inside}\n</section>'


def paragraph(html: str, kind: str = "") -> str:
    """A paragraph of HTML, with a class of the style sheet."""
    return f'<p class="{kind}">{html}</p>' if kind else f"<p>{html}</p>"


def span(html: str, kind: str) -> str:
    """A part of a line, with a class of the style sheet."""
    return f'<span class="{kind}">{html}</span>'


def warnings(heading: str, sentences: Sequence[str]) -> str:
    """A conspicuous box; empty without sentences."""
    if not sentences:
        return ""
    items = "".join(f"<li>{text(sentence)}</li>" for sentence in sentences)
    return f'<div class="warnings" role="note"><strong>{text(heading)}</strong><ul>{items}</ul></div>'


def tiles(parts: Sequence[str]) -> str:
    """Tiles side by side, as many per row as fit."""
    inside = "\n".join(parts)
    return f'<div class="tiles">\n{inside}\n</div>'


def tile(heading: str, rows: Sequence[tuple[str, str]], large: int = 1) -> str:
    """A box with names and values, which are HTML; the first `large` values are large."""
    kinds = [*[' class="main"'] * large, *[""] * len(rows)]
    inside = "".join(f"<dt>{name}</dt><dd{kind}>{value}</dd>" for (name, value), kind in zip(rows, kinds, strict=False))
    return f'<div class="tile"><h3>{text(heading)}</h3><dl>{inside}</dl></div>'


def columns(parts: Sequence[str]) -> str:
    """Parts below each other, in two columns if they fit."""
    inside = "\n".join(f"<div>{part}</div>" for part in parts)
    return f'<div class="columns">\n{inside}\n</div>'


def facts(rows: Sequence[tuple[str, str]]) -> str:
    """A list of names with their descriptions, which are HTML."""
    inside = "\n".join(f"<dt>{name}</dt><dd>{words}</dd>" for name, words in rows)
    return f'<dl class="facts">\n{inside}\n</dl>'


def folded(heading: str, *parts: str) -> str:
    """HTML that a click on its heading unfolds; on paper it is unfolded."""
    inside = "\n".join(part for part in parts if part)
    return f'<details class="folded">\n<summary>{text(heading)}</summary>\n{inside}\n</details>' if inside else ""


def command_line(command: str) -> str:
    """A command to copy; empty without one."""
    return f"<pre><code>{text(command)}</code></pre>" if command else ""


def table(caption: str, head: str, rows: Sequence[Sequence[str]], foot: Sequence[str] = (), words: int = 0) -> str:
    """A table; cells are HTML, `head` has the rows of headings, and the first cell of a row is its name.

    The last `words` columns hold words, the other ones numbers. On a narrow screen a table with many columns becomes a
    list of rows. Every value then has the heading of its column, from the last row of headings.
    """
    labels = [TAG.sub(" ", cell).strip() for cell in HEADING.findall(head.splitlines()[-1])]
    body = "\n".join(_row(row, words, labels) for row in rows)
    last = f"<tfoot>\n{_row(foot, words, labels)}\n</tfoot>\n" if foot else ""
    kind = "table lists" if len(labels) > NARROW else "table"
    return (
        f'<div class="{kind}">\n<table>\n<caption>{caption}</caption>\n<thead>\n{head}\n</thead>\n'
        f"<tbody>\n{body}\n</tbody>\n{last}</table>\n</div>"
    )


def headings(cells: Sequence[str], words: int = 0) -> str:
    """A row of headings; the first is above names, the last `words` are above words."""
    kinds = _kinds(len(cells), words)
    inside = "".join(f'<th scope="col"{kind}>{cell}</th>' for cell, kind in zip(cells, kinds, strict=True))
    return f"<tr>{inside}</tr>"


def _row(cells: Sequence[str], words: int, labels: Sequence[str]) -> str:
    first, *values = cells
    kinds, names = _kinds(len(cells), words)[1:], [*labels[1:], *[""] * len(cells)]
    inside = "".join(
        f'<td{kind} data-label="{name}">{cell}</td>' for cell, kind, name in zip(values, kinds, names, strict=False)
    )
    return f'<tr><th scope="row">{first}</th>{inside}</tr>'


def _kinds(cells: int, words: int) -> list[str]:
    return ["", *[' class="number"'] * (cells - 1 - words), *[""] * words]


def figure(caption: str, inside: str, kind: str = "") -> str:
    """A figure with its caption, both HTML; `kind` is a class of the style sheet.

    `compact` drawings fit any screen, `full` ones are as wide as the page.
    """
    opening = f'<figure class="{kind}">' if kind else "<figure>"
    return f"{opening}\n<figcaption>{caption}</figcaption>\n{inside}\n</figure>"


def panels(captions: Sequence[str], svgs: Sequence[str]) -> str:
    """Small charts side by side, as many per row as fit."""
    inside = "\n".join(
        f'<div class="panel"><div class="name">{caption}</div>\n{svg}</div>'
        for caption, svg in zip(captions, svgs, strict=True)
    )
    return f'<div class="panels">\n{inside}\n</div>'


def legend(marks: Sequence[tuple[str, str, str]]) -> str:
    """Legend of a figure; each mark has a color and a shape, which are classes of the style sheet, and a text."""
    return " &#160; ".join(span(f"{span('', shape)} {name}", color) for color, shape, name in marks)


def switches(marks: Sequence[tuple[str, str, str, str]]) -> str:
    """Legend whose entries switch curves; each mark begins with the key of its curves (see `svg.switched`)."""
    return " ".join(
        f'<span class="switch {color}" data-switch="{key}">{span("", shape)} {name}</span>'
        for key, color, shape, name in marks
    )
