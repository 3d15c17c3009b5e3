"""The page's script in a real browser: names switch curves, panels are zoomed into, and all of it comes back."""

import re
from functools import cache
from typing import Any

import numpy as np
import pytest
from browser_support import browsing
from page_support import parsed, words

pytest.importorskip("matplotlib", reason="pictures need the workstation extra")
from gyrodrift.html.html import figure, header, page, panels, switches
from gyrodrift.html.svg import TUNED, TWO, as_svg, canvas, follows, label_steps, styled, switched

HELPERS = """
const svg = document.querySelector("svg[role=img]");
const names = [...document.querySelectorAll(".switch")];
const paths = key => document.querySelector(`[data-curve=${key}] path`);
const shown = key => getComputedStyle(document.querySelector(`[data-curve=${key}]`)).display !== "none";
const height = key => paths(key).getBBox().height;
const ticks = axis => [...document.querySelectorAll(`[data-axis=${axis}] > .tick`)]
  .filter(one => getComputedStyle(one).display !== "none").map(one => one.textContent.trim());
const drag = (from, to) => {
  const box = document.querySelector("[data-axis=x]").parentElement.querySelector("path").getBoundingClientRect();
  const at = share => ({ clientX: box.left + share * box.width, clientY: box.top + box.height / 2, button: 0 });
  [["pointerdown", from], ["pointermove", to], ["pointerup", to]].forEach(([name, share]) =>
    svg.dispatchEvent(new PointerEvent(name, at(share))));
};
"""


@cache
def two_curves() -> str:
    """A panel of ten minutes with a curve up to 1 and one up to 100."""
    minutes = np.linspace(0.0, 10.0, 101)
    with styled():
        drawing = canvas(3.0, 2.0, inset=0.1, bottom=0.2, top=0.9)
        axes = drawing.add_subplot()
        for key, highest, colour in (("small", 1.0, TUNED), ("large", 100.0, TWO)):
            (line,) = axes.plot(minutes, highest * minutes / 10.0, color=colour)
            switched(line, key)
        follows(axes.axhline(50.0))
        axes.set(xlim=(0.0, 10.0), ylim=(0.0, 100.0))
        label_steps(axes.xaxis, 5)
        label_steps(axes.yaxis, 5)
        svg = as_svg(drawing, "two", "Two curves")
    names = switches([("small", "tuned", "key", "small one"), ("large", "two", "key", "large one")])
    return page("Curves", [header("k", "h"), figure(f"Two. {names}", panels(["<b>one</b>"], [svg]))])


STEPS = """
const state = () => [shown("large"), height("small"), ticks("y"), names[1].getAttribute("aria-pressed")];
const press = key => svg.dispatchEvent(new KeyboardEvent("keydown", { key }));
const both = () => [shown("small"), shown("large")];
const [all, none] = [...document.querySelectorAll("figcaption button")];
const said = { drawn: state() };

names[1].click();
said.without = state();
names[1].dispatchEvent(new KeyboardEvent("keydown", { key: "Enter" }));
said.again = state();

names[0].dispatchEvent(new MouseEvent("click", { shiftKey: true }));
said.alone = both();
none.click();
said.none = both();
all.click();
said.all = both();

said.level = document.querySelector("[data-line] path").getBBox().y;
const line = () => paths("large").getAttribute("d");
said.before = line();
drag(0.4, 0.6);
said.zoomed = [ticks("x"), ticks("y"), line()];
said.followed = document.querySelector("[data-line] path").getBBox().y;
svg.dispatchEvent(new MouseEvent("dblclick"));
said.out = [ticks("x"), ticks("y"), line()];

press("+");
said.nearer = ticks("x");
press("ArrowRight");
said.along = ticks("x");
press("Escape");
said.escaped = ticks("x");

const panel = document.querySelector(".panel"), width = panel.getBoundingClientRect().width;
panel.querySelector(".larger").click();
said.wider = panel.getBoundingClientRect().width / width;
return said;
"""


@pytest.fixture(scope="module")
def said(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What a browser shows after each step, all in one run."""
    folder = tmp_path_factory.mktemp("page")
    shown = folder / "curves.html"
    shown.write_text(two_curves())
    with browsing(folder / "browser") as tab:
        tab.size(1400, 1000)
        tab.open(shown.as_uri())
        tab.until("document.readyState === 'complete' && document.querySelector('.switch')")
        return dict(tab.run(f"(() => {{ {HELPERS + STEPS} }})()"))


def test_without_the_script_the_page_reads_the_same() -> None:
    """Names and curves stand there, and neither hints nor buttons that would do nothing."""
    html = two_curves()
    assert "small one" in words(html)
    assert not any(element.tag == "button" for element in parsed(html).iter())
    assert len(re.findall('data-curve="', html.partition("<body>")[2])) == 2


def test_a_name_switches_its_curve_and_the_scale_follows(said: dict[str, Any]) -> None:
    """Without the large one the small one fills the panel; with both it is as it was drawn."""
    assert said["drawn"] == said["again"]
    is_shown, drawn_high, *others = said["drawn"]
    assert [is_shown, *others] == [True, ["0", "20", "40", "60", "80", "100"], "true"]
    is_shown, high, *others = said["without"]
    assert [is_shown, *others] == [False, ["0", "0.2", "0.4", "0.6", "0.8", "1"], "false"]
    assert high > 50.0 * drawn_high


def test_one_curve_alone_none_and_all(said: dict[str, Any]) -> None:
    """By Shift, and by the buttons."""
    assert [said[step] for step in ("alone", "none", "all")] == [[True, False], [False, False], [True, True]]


def test_dragging_zooms_into_a_time_and_a_double_click_leaves_it(said: dict[str, Any]) -> None:
    """Marks are those of the stretch, on both scales; the curve is drawn anew, and then again as it was."""
    x, y, line = said["zoomed"]
    assert {"4.5", "5", "5.5"} <= set(x) <= {"4", "4.5", "5", "5.5", "6"}
    assert y == ["0", "20", "40", "60"]
    assert line != said["before"]
    assert said["followed"] < said["level"] - 20.0, "the line at 50 rises, since the panel ends at 60 now"
    assert said["out"] == [["0", "2", "4", "6", "8", "10"], said["drawn"][2], said["before"]]


def test_keys_zoom_too(said: dict[str, Any]) -> None:
    """Plus into the middle, an arrow along, Escape out."""
    ends = [(said[step][0], said[step][-1]) for step in ("nearer", "along", "escaped")]
    assert ends == [("3", "7"), ("4", "8"), ("0", "10")]


def test_a_panel_grows_to_the_width_of_the_figure(said: dict[str, Any]) -> None:
    """By its button."""
    assert said["wider"] > 2.0
