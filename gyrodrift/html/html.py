"""A page for a person: HTML in one file, with its style sheet and its one script, that asks the network for nothing."""

import re
from collections.abc import Sequence
from html import escape
from pathlib import Path
from unicodedata import category

STYLE_SHEET = Path(__file__).with_name("page.css")
SCRIPTS = {"data-curve=": Path(__file__).with_name("page.js"), 'class="chart"': Path(__file__).with_name("chart.js")}
"""Scripts, by the mark of the elements that need them."""

POLICY = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:"
"""What a browser lets the page do: it holds all that it needs, and nothing is fetched."""

LISTED = 3
"""From so many chapters on, they are listed at the top."""

CHAPTER = re.compile(r'<section id="([^"]+)">\n<h2>(.*?)</h2>')
HEADING = re.compile(r"<th[^>]*>(.*?)</th>", re.DOTALL)
TAG = re.compile(r"<[^>]*>")

NARROW = 4
"""Tables with more columns than this become lists on a narrow screen."""

FORBIDDEN = ("Cc", "Cs", "Cn")
"""Control characters, halves of characters, and what is no character."""


def text(value: str) -> str:
    """Text as HTML; characters that no page may hold, such as escape codes in a name, are replaced."""
    return escape("".join("\ufffd" if category(one) in FORBIDDEN and one not in "\n\t" else one for one in value))


def page(title: str, body: Sequence[str]) -> str:
    """The file, of a title and the HTML of its parts: the head of the page, then its chapters, which are listed."""
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
    """The list of the chapters; nothing of a few."""
    found = CHAPTER.findall("\n".join(chapters))
    if len(found) < LISTED:
        return ""
    inside = "".join(f'<li><a href="#{name}">{heading}</a></li>' for name, heading in found)
    return f'<nav class="contents" aria-label="Contents"><ol>{inside}</ol></nav>'


def header(kicker: str, headline: str, *parts: str) -> str:
    """What a page opens with: a line above its headline, the headline, and HTML."""
    inside = "\n".join(parts)
    return f'<header>\n<p class="kicker">{text(kicker)}</p>\n<h1>{text(headline)}</h1>\n{inside}\n</header>'


def section(heading: str, *parts: str) -> str:
    """A chapter, to be linked to by its heading, of which no two of a page are the same."""
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
    """A box that cannot be overlooked; nothing where there is nothing to say."""
    if not sentences:
        return ""
    items = "".join(f"<li>{text(sentence)}</li>" for sentence in sentences)
    return f'<div class="warnings" role="note"><strong>{text(heading)}</strong><ul>{items}</ul></div>'


def tiles(parts: Sequence[str]) -> str:
    """Tiles side by side, as many in a row as there is room for."""
    inside = "\n".join(parts)
    return f'<div class="tiles">\n{inside}\n</div>'


def tile(heading: str, rows: Sequence[tuple[str, str]], large: int = 1) -> str:
    """A few values under their names, which are HTML, the first ones large: one, or as many as are said."""
    kinds = [*[' class="main"'] * large, *[""] * len(rows)]
    inside = "".join(f"<dt>{name}</dt><dd{kind}>{value}</dd>" for (name, value), kind in zip(rows, kinds, strict=False))
    return f'<div class="tile"><h3>{text(heading)}</h3><dl>{inside}</dl></div>'


def columns(parts: Sequence[str]) -> str:
    """Parts of words below each other, in two columns where there is room."""
    inside = "\n".join(f"<div>{part}</div>" for part in parts)
    return f'<div class="columns">\n{inside}\n</div>'


def facts(rows: Sequence[tuple[str, str]]) -> str:
    """Names, and what is to be said of each, which is HTML."""
    inside = "\n".join(f"<dt>{name}</dt><dd>{words}</dd>" for name, words in rows)
    return f'<dl class="facts">\n{inside}\n</dl>'


def folded(heading: str, *parts: str) -> str:
    """HTML that a click on its heading unfolds; on paper it is unfolded."""
    inside = "\n".join(part for part in parts if part)
    return f'<details class="folded">\n<summary>{text(heading)}</summary>\n{inside}\n</details>' if inside else ""


def command_line(command: str) -> str:
    """A command to be copied; nothing where there is none."""
    return f"<pre><code>{text(command)}</code></pre>" if command else ""


def table(caption: str, head: str, rows: Sequence[Sequence[str]], foot: Sequence[str] = (), words: int = 0) -> str:
    """A table of cells, which are HTML, with its rows of headings; the first cell of a row names it.

    The last `words` columns hold words, all others numbers. On a narrow screen a table of many columns becomes a list
    of its rows, each value under the heading of its column: those of the last row of headings.
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
    """A row of headings, the first one over names and the last `words` over words."""
    kinds = _kinds(len(cells), words)
    inside = "".join(f'<th scope="col"{kind}>{cell}</th>' for cell, kind in zip(cells, kinds, strict=True))
    return f"<tr>{inside}</tr>"


def _row(cells: Sequence[str], words: int, labels: Sequence[str]) -> str:
    first, *others = cells
    kinds, names = _kinds(len(cells), words)[1:], [*labels[1:], *[""] * len(cells)]
    inside = "".join(
        f'<td{kind} data-label="{name}">{cell}</td>' for cell, kind, name in zip(others, kinds, names, strict=False)
    )
    return f'<tr><th scope="row">{first}</th>{inside}</tr>'


def _kinds(cells: int, words: int) -> list[str]:
    return ["", *[' class="number"'] * (cells - 1 - words), *[""] * words]


def figure(caption: str, inside: str, kind: str = "") -> str:
    """A figure with its caption, which are HTML; with a class of the style sheet.

    `compact` drawings fit any screen, `full` ones are as wide as the page.
    """
    opening = f'<figure class="{kind}">' if kind else "<figure>"
    return f"{opening}\n<figcaption>{caption}</figcaption>\n{inside}\n</figure>"


def panels(captions: Sequence[str], svgs: Sequence[str]) -> str:
    """Small multiples side by side, as many in a row as there is room for."""
    inside = "\n".join(
        f'<div class="panel"><div class="name">{caption}</div>\n{svg}</div>'
        for caption, svg in zip(captions, svgs, strict=True)
    )
    return f'<div class="panels">\n{inside}\n</div>'


def legend(marks: Sequence[tuple[str, str, str]]) -> str:
    """What the marks of a figure are: of each its colour and its shape, as classes of the style sheet, and its name."""
    return " &#160; ".join(span(f"{span('', shape)} {name}", colour) for colour, shape, name in marks)


def switches(marks: Sequence[tuple[str, str, str, str]]) -> str:
    """A legend whose names switch curves: of each the key of its curves (see `svg.switched`), and as in `legend`."""
    return " ".join(
        f'<span class="switch {colour}" data-switch="{key}">{span("", shape)} {name}</span>'
        for key, colour, shape, name in marks
    )
