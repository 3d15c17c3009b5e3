"""Charts of a page in a real browser: names switch curves, charts are zoomed into, copied, saved and printed."""

from functools import cache
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from browser_support import browsing
from page_support import charts, parsed, shown, words

from gyrodrift.report.chart import AxisScale, Chart, ChartSeries, Mark, Part, ScaleKind, Shape, line
from gyrodrift.report.page import bold, page

MINUTES = np.linspace(0.0, 10.0, 101)
MARKS = (Mark("small", "tuned", "key", "small one"), Mark("large", "two", "key dashed", "large one"))

HELPERS = """
const saved = [], copied = [];
URL.createObjectURL = blob => { saved.push(blob); return "blob:x"; };
URL.revokeObjectURL = () => {};
HTMLAnchorElement.prototype.click = function () { saved.push(this.download); };
Object.defineProperty(navigator, "clipboard", { configurable: true, value: {
  writeText: async text => { copied.push(text); },
  write: async items => { copied.push(await items[0].getType("image/png")); },
} });
const wait = async condition => { while (!condition()) await new Promise(done => setTimeout(done, 20)); };
const [panel, single] = [...document.querySelectorAll("details.save")];
const press = async (menu, text) => {
  const button = [...menu.querySelectorAll("button")].find(one => one.textContent === text);
  button.click();
  await wait(() => button.textContent === "done");
};
const chart = document.querySelector(".chart"), over = chart.querySelector(".u-over");
const names = [...document.querySelectorAll(".switch")];
const drawing = async () => {
  await new Promise(done => setTimeout(done, 20));
  const before = copied.length;
  panel.querySelectorAll("button")[2].click();
  await wait(() => copied.length > before);
  const holder = document.createElement("div");
  holder.innerHTML = copied.at(-1);
  document.body.append(holder);
  const path = key => holder.querySelector(`[data-curve="${key}"]`), height = key => path(key)?.getBBox().height ?? 0;
  const texts = anchor => [...holder.querySelectorAll(`[text-anchor="${anchor}"]`)].map(one => one.textContent);
  const ticks = anchor => texts(anchor).filter(text => /\\d/.test(text));
  const level = [...holder.querySelectorAll("[data-curve='']")].map(one => one.getBBox().y);
  const curves = [...holder.querySelectorAll("[data-curve]")].map(one => one.dataset.curve).filter(Boolean);
  const line = path("large")?.getAttribute("d");
  const state = { curves, small: height("small"), x: ticks("middle"), y: ticks("end"), line, level: level[0] };
  holder.remove();
  return state;
};
const mouse = (target, kind, share) => {
  const box = over.getBoundingClientRect();
  target.dispatchEvent(new MouseEvent(kind, { clientX: box.left + share * box.width, clientY: box.top + box.height / 2,
    button: 0, movementX: 5, bubbles: true, cancelable: true, view: window }));
};
const drag = (from, to) => {
  [["mousemove", from], ["mousedown", from], ["mousemove", to], ["mouseup", to]].forEach(step => mouse(over, ...step));
};
"""

STEPS = """
const key = name => chart.dispatchEvent(new KeyboardEvent("keydown", { key: name }));
const [all, none] = [...document.querySelectorAll("figcaption > button")];
const said = { drawn: await drawing(), pressed: names.map(one => one.getAttribute("aria-pressed")) };

names[1].click();
said.without = await drawing();
said.off = names[1].getAttribute("aria-pressed");
names[1].dispatchEvent(new KeyboardEvent("keydown", { key: "Enter" }));
said.again = await drawing();

names[0].dispatchEvent(new MouseEvent("click", { shiftKey: true }));
said.alone = (await drawing()).curves;
none.click();
said.none = (await drawing()).curves;
all.click();
said.all = (await drawing()).curves;

drag(0.4, 0.6);
said.zoomed = await drawing();
mouse(over, "dblclick", 0.5);
said.out = await drawing();

key("+");
said.nearer = (await drawing()).x;
key("ArrowRight");
said.along = (await drawing()).x;
key("Escape");
said.escaped = (await drawing()).x;

mouse(over, "mouseenter", 0.5);
mouse(over, "mousemove", 0.5);
await new Promise(done => setTimeout(done, 100));
said.values = [...chart.querySelectorAll(".values span")].map(one => one.textContent);

const place = document.querySelector(".panel"), width = place.getBoundingClientRect().width;
place.querySelector(".larger").click();
said.wider = place.getBoundingClientRect().width / width;
return said;
"""

COPIES = """
const result = { menus: document.querySelectorAll("details.save").length };
panel.open = true;
await press(panel, "save SVG");
result.svg = await saved[0].text();
result.name = saved[1];
document.body.click();
result.closed = !panel.open;

names[1].click();
await press(panel, "copy SVG");
result.without = copied[0];
await press(single, "save PNG");
const image = await createImageBitmap(saved[2]);
result.png = [saved[2].type, image.width, saved[3]];
const pixels = Object.assign(document.createElement("canvas"), { width: 1, height: 1 }).getContext("2d");
pixels.drawImage(image, 0, 0);
result.corner = [...pixels.getImageData(0, 0, 1, 1).data];
await press(panel, "copy PNG");
result.copied = copied[1].type;
dispatchEvent(new Event("beforeprint"));
result.printed = document.querySelectorAll(".chart > svg").length;
dispatchEvent(new Event("afterprint"));
result.left = document.querySelectorAll(".chart > svg").length;
return result;
"""


@cache
def written() -> str:
    """A panel of ten minutes with a curve up to 1 and one up to 100, and a chart of its own with every shape."""
    curves = [
        ChartSeries(MINUTES, MINUTES / 10.0, "tuned", key="small", name="small"),
        ChartSeries(MINUTES, 10.0 * MINUTES, "two", key="large", name="large"),
        line(y=50.0, color="quiet"),
    ]
    x = AxisScale("minutes", 0.0, 10.0)
    chart = Chart("Two curves", x, [Part(AxisScale("error, deg", 0.0, 100.0), curves)], 210)
    shapes = [ChartSeries(MINUTES, MINUTES, "plain", shape, MINUTES + 0.05, 2.0 * MINUTES) for shape in Shape]
    second = Chart("Every shape", x, [Part(AxisScale("deg", -300.0, 0.5, ScaleKind.SYMLOG), shapes)])
    source = """{% call blocks.figure(blocks.panels([(name, chart)])) %}Two. {{ blocks.legend(marks) }}{% endcall %}
        {% call blocks.figure(blocks.chart(other), "compact") %}<b>Alone.</b> {{ blocks.legend(dots) }}{% endcall %}"""
    dots = [Mark("", "plain", "dot", "some dots")]
    section = shown(source, name=bold("Yaw error"), chart=chart, other=second, marks=MARKS, dots=dots)
    return page("A session", [shown("<h1>h</h1>"), section])


def run(folder: Path, script: str) -> dict[str, Any]:
    """Values of a script in the page, opened from the disk on a dark screen."""
    (folder / "charts.html").write_text(written())
    with browsing(folder / "browser") as tab:
        tab.scheme("dark")
        tab.size(1400, 1000)
        tab.open((folder / "charts.html").as_uri())
        tab.until("document.readyState === 'complete' && document.querySelector('.chart .u-over')")
        values = dict(tab.run(f"(async () => {{ {HELPERS + script} }})()"))
        assert tab.errors == []
        return values


@pytest.fixture(scope="module")
def statement(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    return run(tmp_path_factory.mktemp("page"), STEPS)


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Copies and files of a page."""
    return run(tmp_path_factory.mktemp("page"), COPIES)


def test_without_the_script_the_page_reads_the_same() -> None:
    """Names stand there, and neither hints nor buttons that would do nothing."""
    html = written()
    assert "small one" in words(html)
    assert "The charts need JavaScript." in words(html)
    assert not any(element.tag in {"button", "details"} for element in parsed(html).iter())
    assert [len(chart["parts"][0]["series"]) for chart in charts(html)] == [3, 5]


def test_a_name_switches_its_curve_and_the_scale_follows(statement: dict[str, Any]) -> None:
    assert statement["drawn"] == statement["again"]
    assert statement["pressed"] == ["true", "true"]
    assert (statement["drawn"]["curves"], statement["drawn"]["y"]) == (
        ["small", "large"],
        ["0", "20", "40", "60", "80", "100"],
    )
    assert (statement["without"]["curves"], statement["off"]) == (["small"], "false")
    assert {"0", "0.2", "0.4", "0.6", "0.8", "1"} <= set(statement["without"]["y"])
    assert statement["without"]["small"] > 50.0 * statement["drawn"]["small"]


def test_one_curve_alone_none_and_all(statement: dict[str, Any]) -> None:
    assert [statement[step] for step in ("alone", "none", "all")] == [["small"], [], ["small", "large"]]


def test_dragging_zooms_into_a_time_and_a_double_click_leaves_it(statement: dict[str, Any]) -> None:
    """Marks are those of the stretch, on both scales; the curve is drawn again, and then again as it was."""
    zoomed = statement["zoomed"]
    assert {"4.5", "5", "5.5"} <= set(zoomed["x"])
    assert all(3.9 <= float(tick) <= 6.1 for tick in zoomed["x"])
    assert {"0", "20", "40", "60"} <= set(zoomed["y"])
    assert "80" not in zoomed["y"]
    assert zoomed["line"] != statement["drawn"]["line"]
    assert zoomed["level"] < statement["drawn"]["level"] - 20.0, "the line at 50 rises, since the panel ends at 60 now"
    assert statement["out"] == statement["drawn"]


def test_keys_zoom_too(statement: dict[str, Any]) -> None:
    """Plus into the middle, an arrow along, Escape out."""
    ends = [(statement[step][0], statement[step][-1]) for step in ("nearer", "along", "escaped")]
    assert ends == [("3", "7"), ("4", "8"), ("0", "10")]


def test_values_are_shown_under_the_pointer(statement: dict[str, Any]) -> None:
    time, small, large = statement["values"]
    assert time.startswith("minutes: 5")
    assert (small, large) == ("small 0.5", "large 50")


def test_a_panel_grows_to_the_width_of_the_figure(statement: dict[str, Any]) -> None:
    assert statement["wider"] > 2.0


def test_every_chart_has_a_menu_that_a_click_elsewhere_closes(result: dict[str, Any]) -> None:
    """A panel has it beside its name, a chart of its own beside its caption."""
    assert (result["menus"], result["closed"]) == (2, True)


def test_a_saved_chart_has_its_name_its_legend_and_colors_of_paper(result: dict[str, Any]) -> None:
    assert result["name"] == "a-session-yaw-error.svg"
    texts = ["".join(item.itertext()) for item in ET.fromstring(result["svg"]).iter("{http://www.w3.org/2000/svg}text")]
    assert (texts[0], texts[-2:]) == ("Yaw error", ["small one", "large one"])
    assert {"error, deg", "minutes"} <= set(texts)
    assert "var(--" not in result["svg"]
    assert 'fill="#ffffff"' in result["svg"]


def test_a_curve_that_is_switched_off_is_not_copied(result: dict[str, Any]) -> None:
    root = ET.fromstring(result["without"])
    assert [item.get("data-curve") for item in root.iter() if item.get("data-curve")] == ["small"]
    assert "large one" not in result["without"]


@pytest.mark.promise("Analyses and reports")
def test_a_chart_is_a_picture_too(result: dict[str, Any]) -> None:
    """Every chart of a page can be copied or saved as SVG or PNG, also from a local file."""
    assert result["png"] == ["image/png", 1600, "a-session-alone.png"]
    assert result["corner"] == [255, 255, 255, 255]
    assert result["copied"] == "image/png"


def test_paper_gets_lines_and_not_pixels(result: dict[str, Any]) -> None:
    assert (result["printed"], result["left"]) == (2, 0)
