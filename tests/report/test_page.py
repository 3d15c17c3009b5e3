"""A page for a person: text stays text, and every part is whole HTML."""

import re
from pathlib import Path

import numpy as np
from browser_support import browsing
from page_support import parsed, row, shown, words

from gyrodrift.report.chart import AxisScale, Chart, ChartSeries, Mark, Part
from gyrodrift.report.page import Section, bold, code, marked, page

HEAD = shown('{% call blocks.header("k", "h") %}{% endcall %}')
CHART = Chart(
    "Two <points>",
    AxisScale("s", 0.0, 1.0),
    [Part(AxisScale("deg", 0.0, 1.0), [ChartSeries(np.ones(1), np.ones(1), "ink")])],
)


def test_text_is_escaped() -> None:
    name = "<a href='x'>&\"\n"
    html = page(
        name, [shown('<p title="{{ name }}">{{ name }}{{ marked }}</p>', name=name, marked=bold(name) + code(name))]
    )
    (paragraph,) = parsed(html).iter("p")
    assert "".join(paragraph.itertext()) == 3 * name
    assert str(paragraph.get("title")).strip() == name.strip()
    assert "<a " not in html


def test_what_no_page_may_hold_is_replaced() -> None:
    """Control characters, halves of characters, and what is no character."""
    html = page("T", [shown("<p>{{ name }}</p>", name="red\x1b[31m \x00 \udc80 \ufffe\t")])
    assert "<p>red\ufffd[31m \ufffd \ufffd \ufffd\t</p>" in html


def test_all_parts_together_are_a_page() -> None:
    """Every element closed, in the order that they were given."""
    head = """{% call blocks.header("a & b", "It <works>") %}
        {{ blocks.warnings("First", ["one < two"]) }}
        {% call blocks.tile("E") %}{{ blocks.row("now", "1°") }}{{ blocks.row("then", "2°") }}{% endcall %}
        {% endcall %}"""
    numbers = """<p class="note">small</p>
        {% call blocks.figure(blocks.panels(panels)) %}{{ blocks.legend(marks) }}{% endcall %}
        <dl><dt>Seed</dt><dd>1</dd></dl>{{ blocks.command("gyrodrift tune <here>") }}"""
    body = [
        shown(head),
        None,
        shown(
            numbers, "Numbers", panels=[("left", CHART), ("right", CHART)], marks=[Mark("", "plain", "key", "plain")]
        ),
    ]
    statement = words(page("A & B", body))
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
    assert re.search(".*".join(map(re.escape, order)), statement, re.DOTALL)


def test_what_is_empty_leaves_no_mark() -> None:
    assert str(shown('{{ blocks.warnings("First", []) }}{{ blocks.command("") }}').__html__()).strip() == ""


def test_numbers_of_a_table_stand_to_the_right() -> None:
    table = '{{ blocks.table("Caption", head, [["a", "1", "2", "long"]], ["mean", "1", "2", ""], words=1) }}'
    html = page("T", [shown(table, head=["name", "E", "NE", "meaning"])])
    assert row(html, "a") == ["a", "1", "2", "long"]
    assert row(html, "mean") == ["mean", "1", "2", ""]
    for cells in parsed(html).iter("tr"):
        assert [cell.get("class") for cell in cells] == [None, "number", "number", None]


def test_chapters_are_listed_from_three_on() -> None:
    chapters = [shown("x", "The <first>"), shown("y", "Second"), shown("z", "Third")]
    assert "Contents" not in page("T", [HEAD, *chapters[:2]])
    root = parsed(page("T", [HEAD, *chapters]))
    links = {str(link.get("href")).removeprefix("#"): link.text for link in root.iter("a")}
    assert links == {"the-first": "The <first>", "second": "Second", "third": "Third"}
    assert [item.get("id") for item in root.iter("section")] == list(links)


def test_values_of_a_wide_table_know_their_headings() -> None:
    """A narrow screen shows them as a list: with their heading, without its tags."""
    head = ["name", marked("plain", "E,"), "NE", "PI", "largest"]
    root = parsed(page("T", [shown('{{ blocks.table("", head, [["a", "1", "2", "3", "4"]]) }}', head=head)]))
    assert [cell.get("data-label") for cell in root.iter("td")] == ["E,", "NE", "PI", "largest"]
    assert [item.get("class") for item in root.iter("div")] == ["table lists"]


def test_a_page_fetches_nothing_and_has_a_script_only_for_charts() -> None:
    """A browser is told so too; uPlot comes with its license."""
    plain = parsed(page("T", [HEAD]))
    assert [
        item.get("content") for item in plain.iter("meta") if item.get("http-equiv") == "Content-Security-Policy"
    ] == ["default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:"]
    assert not list(plain.iter("script"))
    uplot, ours = parsed(page("T", [HEAD, shown("{{ blocks.chart(chart) }}", chart=CHART)])).iter("script")
    assert "MIT License" in (uplot.text or "")
    assert "addEventListener" in (ours.text or "")


def test_a_main_value_of_a_tile_is_large() -> None:
    tile = '{% call blocks.tile("E") %}{{ blocks.row("now", "1°", "main") }}{{ blocks.row("then", "2°") }}{% endcall %}'
    result = parsed(page("T", [shown(tile)])).iter("dd")
    assert [value.get("class") for value in result] == ["main", None]


def test_a_section_is_known_by_its_heading() -> None:
    assert Section("x.html", {}, "Yaw & its error: over time").anchor == "yaw-its-error-over-time"


def test_folded_details_are_printed_in_full(tmp_path: Path) -> None:
    tall = '<svg width="99" height="2500"><rect width="99" height="2500"/></svg>'
    folded = shown(f'{{% call blocks.folded("Details") %}}{tall}{{% endcall %}}')
    (tmp_path / "page.html").write_text(page("T", [HEAD, folded]))
    with browsing(tmp_path / "browser") as tab:
        tab.open((tmp_path / "page.html").as_uri())
        tab.until("document.querySelector('details.folded')")
        assert tab.run("document.documentElement.scrollHeight") < 1500
        assert len(re.findall(rb"/Type\s*/Page\b", tab.paper())) >= 3
