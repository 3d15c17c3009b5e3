"""Charts of a page in a real browser: each can be copied, or saved as SVG or PNG, as the page shows it."""

from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
import pytest
from browser_support import browsing
from page_support import parsed

pytest.importorskip("matplotlib", reason="pictures need the workstation extra")
from gyrodrift.html.html import figure, header, legend, page, panels, switches
from gyrodrift.html.svg import TUNED, TWO, as_svg, canvas, styled, switched

SCRIPT = """
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
const result = { menus: document.querySelectorAll("details.save").length };

panel.open = true;
await press(panel, "save SVG");
result.svg = await saved[0].text();
result.name = saved[1];
document.body.click();
result.closed = !panel.open;

document.querySelectorAll(".switch")[1].click();
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
return result;
"""


def _svg(name: str) -> str:
    drawing = canvas(3.0, 2.0, inset=0.1, bottom=0.2, top=0.9)
    axes = drawing.add_subplot()
    for key, slope, color in (("low", 1.0, TUNED), ("high", 2.0, TWO)):
        (line,) = axes.plot(np.arange(5.0), slope * np.arange(5.0), color=color)
        switched(line, key)
    return as_svg(drawing, name, "Two curves")


def _page() -> str:
    with styled():
        small, single = _svg("small"), _svg("single")
    names = switches([("low", "tuned", "key", "low curve"), ("high", "two", "key dashed", "high curve")])
    caption = f"<b>Alone.</b> {legend([('plain', 'dot', 'some dots')])}"
    charts = [figure(f"Panels. {names}", panels(["<b>Yaw error</b>"], [small])), figure(caption, single, "compact")]
    return page("A session", [header("k", "h"), *charts])


@pytest.fixture(scope="module")
def result(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Copies and files of a page in the dark scheme, opened from the disk."""
    folder = tmp_path_factory.mktemp("page")
    (folder / "charts.html").write_text(_page())
    with browsing(folder / "browser") as tab:
        tab.scheme("dark")
        tab.open((folder / "charts.html").as_uri())
        tab.until("document.readyState === 'complete' && document.querySelector('details.save')")
        values = dict(tab.run(f"(async () => {{ {SCRIPT} }})()"))
        assert tab.errors == []
        return values


def test_a_chart_without_the_script_has_no_button() -> None:
    """The buttons come with the script that serves them."""
    html = _page()
    assert html.count('class="chart"') == 2
    assert not any(element.tag == "details" for element in parsed(html).iter())


def test_every_chart_has_a_menu_that_a_click_elsewhere_closes(result: dict[str, Any]) -> None:
    """A panel has it beside its name, a chart of its own beside its caption."""
    assert (result["menus"], result["closed"]) == (2, True)


def test_a_saved_chart_has_its_name_its_legend_and_colors_of_paper(result: dict[str, Any]) -> None:
    """Also while the screen is dark; no color refers to the page."""
    assert result["name"] == "a-session-yaw-error.svg"
    texts = ["".join(one.itertext()) for one in ET.fromstring(result["svg"]).iter("{http://www.w3.org/2000/svg}text")]
    assert (texts[0], texts[-2:]) == ("Yaw error", ["low curve", "high curve"])
    assert "var(--" not in result["svg"]
    assert 'fill="#ffffff"' in result["svg"]


def test_a_curve_that_is_switched_off_is_not_copied(result: dict[str, Any]) -> None:
    """Neither its line nor its entry of the legend."""
    root = ET.fromstring(result["without"])
    assert [one.get("data-curve") for one in root.iter() if one.get("data-curve")] == ["low"]
    assert "high curve" not in result["without"]


def test_a_chart_is_a_picture_too(result: dict[str, Any]) -> None:
    """White paper, wide enough for print."""
    assert result["png"] == ["image/png", 1600, "a-session-alone.png"]
    assert result["corner"] == [255, 255, 255, 255]
    assert result["copied"] == "image/png"
