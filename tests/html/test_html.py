"""A page for a person: text stays text, and every part is whole HTML."""

import re
from pathlib import Path

from browser_support import browsing
from page_support import parsed, row, words

from gyrodrift.html.html import (
    command_line,
    facts,
    figure,
    folded,
    header,
    headings,
    legend,
    page,
    panels,
    paragraph,
    section,
    switches,
    table,
    text,
    tile,
    tiles,
    warnings,
)


def test_text_is_escaped() -> None:
    """Quotes too, since it may stand in an attribute."""
    assert text("<a href='x'>&\"\n") == "&lt;a href=&#x27;x&#x27;&gt;&amp;&quot;\n"


def test_what_no_page_may_hold_is_replaced() -> None:
    """Control characters, halves of characters, and what is no character."""
    assert text("red\x1b[31m \x00 \udc80 \ufffe") == "red\ufffd[31m \ufffd \ufffd \ufffd"


def test_all_parts_together_are_a_page() -> None:
    """Every element closed, in the order that they were given."""
    body = [
        header(
            "a & b", "It <works>", warnings("First", ["one < two"]), tiles([tile("E", [("now", "1°"), ("then", "2°")])])
        ),
        section(
            "Numbers",
            paragraph("small", "note"),
            figure(legend([("plain", "key", "plain")]), panels(["left", "right"], ["<svg></svg>"] * 2)),
            facts([("Seed", "1")]),
            command_line("gyrodrift tune <here>"),
        ),
    ]
    said = words(page("A & B", body))
    order = [
        "a & b",
        "It <works>",
        "First",
        "one < two",
        "now",
        "1°",
        "then",
        "2°",
        "Numbers",
        "small",
        "plain",
        "left",
    ]
    order += ["right", "Seed", "1", "gyrodrift tune <here>"]
    assert re.search(".*".join(map(re.escape, order)), said, re.DOTALL)


def test_what_is_empty_leaves_no_mark() -> None:
    """No box without warnings, no command without one, and no part of a section."""
    assert warnings("First", []) == command_line("") == ""
    assert section("Empty", "", "<p>x</p>", "") == '<section id="empty">\n<h2>Empty</h2>\n<p>x</p>\n</section>'


def test_numbers_of_a_table_stand_to_the_right() -> None:
    """Between the name of a row and the columns of words."""
    head = headings(["name", "E", "NE", "meaning"], words=1)
    html = page("T", [table("Caption", head, [["a", "1", "2", "long"]], ["mean", "1", "2", ""], words=1)])
    assert row(html, "a") == ["a", "1", "2", "long"]
    assert row(html, "mean") == ["mean", "1", "2", ""]
    for cells in parsed(html).iter("tr"):
        assert [cell.get("class") for cell in cells] == [None, "number", "number", None]


def test_chapters_are_listed_from_three_on() -> None:
    """Each with a link to it; fewer are seen at once."""
    chapters = [section("The <first>", "x"), section("Second", "y"), section("Third", "z")]
    assert "Contents" not in page("T", [header("k", "h"), *chapters[:2]])
    root = parsed(page("T", [header("k", "h"), *chapters]))
    links = {str(link.get("href")).removeprefix("#"): link.text for link in root.iter("a")}
    assert links == {"the-first": "The <first>", "second": "Second", "third": "Third"}
    assert [one.get("id") for one in root.iter("section")] == list(links)


def test_values_of_a_wide_table_know_their_headings() -> None:
    """A narrow screen shows them as a list: with the last row of headings, without its tags."""
    group = '<tr><th></th><th colspan="4">all</th></tr>\n'
    head = group + headings(["name", "E,<br/>deg", "NE", "PI", "largest"])
    root = parsed(page("T", [table("", head, [["a", "1", "2", "3", "4"]])]))
    assert [cell.get("data-label") for cell in root.iter("td")] == ["E, deg", "NE", "PI", "largest"]
    assert [one.get("class") for one in root.iter("div")] == ["table lists"]


def test_a_page_fetches_nothing_and_has_a_script_only_for_curves() -> None:
    """A browser is told so too."""
    plain = parsed(page("T", [header("k", "h")]))
    assert [one.get("content") for one in plain.iter("meta") if one.get("http-equiv") == "Content-Security-Policy"] == [
        "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:"
    ]
    assert not list(plain.iter("script"))
    curves = page(
        "T", [header("k", "h"), figure(switches([("a", "two", "key", "A")]), '<svg><g data-curve="a"/></svg>')]
    )
    (script,) = parsed(curves).iter("script")
    assert "addEventListener" in (script.text or "")


def test_the_first_value_of_a_tile_is_large() -> None:
    """The others are not."""
    found = parsed(page("T", [tile("E", [("now", "1°"), ("then", "2°"), ("once", "3°")])])).iter("dd")
    assert [value.get("class") for value in found] == ["main", None, None]


def test_folded_details_are_printed_in_full(tmp_path: Path) -> None:
    """On a screen a click unfolds them; paper has no clicks."""
    assert folded("Details", "") == ""
    tall = '<svg width="99" height="2500"><rect width="99" height="2500"/></svg>'
    (tmp_path / "page.html").write_text(page("T", [header("k", "h"), folded("Details", tall)]))
    with browsing(tmp_path / "browser") as tab:
        tab.open((tmp_path / "page.html").as_uri())
        tab.until("document.querySelector('details.folded')")
        assert tab.run("document.documentElement.scrollHeight") < 1500
        assert len(re.findall(rb"/Type\s*/Page\b", tab.paper())) >= 3
