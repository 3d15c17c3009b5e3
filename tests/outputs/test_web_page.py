"""The page in a real browser: what a person sees of a stream, of its end and of its return."""

import json
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from math import nan
from pathlib import Path

import pytest
from browser_support import Tab, browsing
from outputs_support import HubThread, corrected, csv_at_100_hz, hub, path_of, serving, tilted, with_own_yaw
from support import Command, never

from gyrodrift.outputs.status import ClientStatus, ConfigStatus, DeviceStatus, LinkStatus, OutputStatus, ServiceStatus
from gyrodrift.session.files import load_session

pytestmark = pytest.mark.xdist_group("browser")

STATUS = ServiceStatus(
    version="1.2.3",
    pid=1,
    link=LinkStatus(port="/dev/gyro", protocol="native", is_open=True, rate_hz=100.0, samples=12345, gaps=1, missing=3),
    device=DeviceStatus(device_id="table", sample_rate_hz=100.0),
    config=ConfigStatus(file="my.yaml", filter="restlevel", params={"window_s": 0.3}),
    outputs=(
        OutputStatus("web", "http://127.0.0.1:8117", clients=(ClientStatus("127.0.0.1:5", 7, 0),), client_count=1),
    ),
)

PHONE = (360, 740)

INK = """(() => {
  const canvas = document.querySelectorAll("#charts canvas")[%d];
  const data = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
  const colours = new Set();
  for (let at = 0; at < data.length; at += 4) if (data[at + 3] > 250) colours.add(data.slice(at, at + 3).join());
  return colours.size;
})()"""
"""How many colours one of the charts is drawn in."""

HISTORY = """(async () => {
  const { History } = await import("/history.js");
  const history = new History(["t_s", "v", "v_lo", "v_hi"]);
  const count = 3600 * 30 * 2;
  for (let at = 0; at < count; at++) history.add([at / 30, 1, 1, at === count - 90000 ? 99 : 1]);
  history.add([5, 0, 0, 0]);
  const view = history.view(history.lastS - 3600, history.lastS, 800);
  const few = history.view(history.lastS - 10, history.lastS, 800);
  history.add([history.lastS + 60, 2, 2, 2]);
  const gap = history.view(history.lastS - 65, history.lastS, 800).span("v");
  return {
    rows: view.to - view.from, greatest: Math.max(...view.span("v").filter(Number.isFinite)),
    kept: history.lastS - history.levels[0].columns[0][0], room: history.levels[0].columns[0].length,
    fine: few.to - few.from, holes: gap.filter((value) => value === null).length, last: history.last("v"),
  };
})()"""

BOXES = """["#dial svg", "#horizon svg", "#main-value"].map((part) => {
  const box = document.querySelector(part).getBoundingClientRect();
  return [box.left, box.right, box.top, box.bottom];
})"""

LOOK_BACK = """(() => {
  const back = document.querySelector("#back");
  back.value = Number(back.min) + 100;
  back.dispatchEvent(new Event("input"));
})()"""


@pytest.fixture(scope="module")
def tab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Tab]:
    """A browser for all tests here, which takes seconds to come up."""
    with browsing(tmp_path_factory.mktemp("browser")) as result:
        yield result


@pytest.fixture
def page(tab: Tab) -> Iterator[Tab]:
    """Light and wide at first; whatever the page complains of fails the test."""
    tab.size(1280, 900)
    tab.scheme("light")
    tab.errors.clear()
    tab.requests.clear()
    yield tab
    assert tab.errors == []
    tab.open("about:blank")


@contextmanager
def live(page: Tab) -> Iterator[HubThread]:
    """Outputs whose page is open in the browser."""
    with hub("web:port=0") as outputs:
        page.open(outputs.address)
        page.until("document.querySelector('#connection').innerText === 'Live'")
        yield outputs


def test_it_shows_the_stream_and_moves_with_it(page: Tab) -> None:
    """Dial, numbers, charts, link in words, config, clients; and it asks nobody else for anything."""
    with live(page) as outputs:
        outputs.samples([corrected(seq, yaw_deg=10.0, heading_deg=nan) for seq in range(200)])
        outputs.status(STATUS)
        outputs.event("config_applied", file="my.yaml", changes=["restlevel.window_s: 0.2 → 0.3"])
        page.until("document.querySelector('#main-value').innerText === '10.00°'")
        assert page.run("document.querySelector('#dial .yaw').getAttribute('transform')") == "rotate(-10.00)"
        page.until(f"{INK % 0} > 3")
        before = page.run("document.querySelector('#charts canvas').toDataURL()")
        outputs.samples([corrected(seq, yaw_deg=-45.0, heading_deg=nan) for seq in range(300, 310)])
        page.until("document.querySelector('#main-value').innerText === '−45.00°'")
        page.until(f"document.querySelector('#charts canvas').toDataURL() !== {before!r}")
        page.until("document.querySelector('#config-events code')")
        assert page.text("#main-sigma") == "± 0.50° (1σ)"
        assert "+0.2500 ± 0.0100 deg/s" in page.text("#values")
        assert page.text("#health") == "Lost: 3 samples in 1 gap."
        assert page.text("#device") == "table on /dev/gyro"
        assert "window_s\n0.3" in page.text("#config")
        assert "restlevel.window_s: 0.2 → 0.3" in page.text("#config-events")
        assert "127.0.0.1:5" in page.text("#clients")
        outputs.samples([corrected(400, heading_deg=90.0)])
        page.until("document.querySelector('#main-name').innerText === 'Heading'")
        assert page.run("document.querySelector('#dial .yaw').getAttribute('transform')") == "rotate(90.00)"
        assert all(request.split("://")[1].startswith(outputs.address.split("://")[1]) for request in page.requests)
        page.open("about:blank")


def test_it_fits_a_telephone_and_is_dark_where_that_is_wanted(page: Tab) -> None:
    with hub("web:port=0") as outputs:
        page.size(*PHONE, is_phone=True)
        page.open(outputs.address)
        outputs.status(STATUS)
        outputs.samples([corrected(seq) for seq in range(200)])
        page.until("document.querySelector('#values dd')")
        page.until(f"{INK % 0} > 3")
        assert page.run("document.documentElement.scrollWidth") == PHONE[0]
        light = page.run(
            "[getComputedStyle(document.body).backgroundColor, document.querySelector('canvas').toDataURL()]"
        )
        page.scheme("dark")
        page.until(f"document.querySelector('canvas').toDataURL() !== {light[1]!r}")
        assert page.run("getComputedStyle(document.body).backgroundColor") != light[0]
        page.open("about:blank")


@pytest.mark.promise("Clients of outputs")
def test_a_tilted_device_has_a_horizon(page: Tab) -> None:
    """The horizon of the page has a label and words."""
    with live(page) as outputs:
        outputs.samples([corrected(seq, yaw_deg=10.0, heading_deg=nan) for seq in range(100)])
        page.until("document.querySelector('#main-value').innerText === '10.00°'")
        assert page.run("document.querySelector('#horizon').hidden && document.querySelector('#tilt').hidden")
        assert "Roll" not in page.text("#values") + page.text("#charts")
        outputs.samples([tilted(200)])
        page.until("document.querySelector('#tilt').innerText.includes('Nose 20.0° up')")
        assert "Right side 10.0° down" in page.text("#tilt")
        label = page.run("document.querySelector('#horizon svg').getAttribute('aria-label')")
        assert label == "Horizon. Right side 10.0° down; Nose 20.0° up."
        world = "document.querySelector('#horizon svg > g > g')"
        assert page.run(f"{world}.getAttribute('transform')") == "rotate(-10.00) translate(0 44.44)"
        assert "Roll and pitch, deg" in page.text("#charts")
        for value in ("Roll\n+10.0°", "Pitch\n−20.0°", "Tilt\n22.3 ± 0.40°"):
            assert value in page.text("#values")
        outputs.samples([corrected(300)])
        page.until("document.querySelector('#horizon').hidden && document.querySelector('#tilt').hidden")
        page.open("about:blank")


def test_a_device_with_a_filter_shows_both_yaws_and_a_chart_of_their_difference(page: Tab) -> None:
    with live(page) as outputs:
        outputs.samples([corrected(seq, yaw_deg=10.0, heading_deg=nan) for seq in range(100)])
        page.until("document.querySelector('#main-value').innerText === '10.00°'")
        assert "Device yaw" not in page.text("#values")
        assert "own" not in page.text("#charts")
        outputs.samples([with_own_yaw(corrected(seq)) for seq in range(200, 300)])
        page.until("document.querySelector('#values').innerText.includes('Device yaw')")
        outputs.samples([corrected(300)._replace(device_difference_deg=-0.25)])
        page.until("document.querySelector('#values').innerText.includes('3.75')")
        assert "Device yaw\n2.50° ± 0.13°" in page.text("#values")
        assert "Difference\n−0.25°" in page.text("#values")
        assert "Yaw minus the device's own, deg" in page.text("#charts")
        page.open("about:blank")


def test_a_horizon_fits_a_telephone(page: Tab) -> None:
    page.size(*PHONE, is_phone=True)
    with live(page) as outputs:
        outputs.samples([tilted(0, yaw_deg=-12345.0, heading_deg=nan)])
        page.until("!document.querySelector('#tilt').hidden")
        assert page.run("document.documentElement.scrollWidth") == PHONE[0]
        dial, horizon, value = page.run(BOXES)
        assert dial[1] <= horizon[0] < horizon[1] <= value[0]
        assert value[2] < dial[3]
        sky = "getComputedStyle(document.querySelector('#horizon .sky')).fill"
        light = page.run(sky)
        page.scheme("dark")
        page.until(f"{sky} !== {light!r}")
        page.open("about:blank")


def test_a_local_person_zeroes_sets_a_heading_and_records(page: Tab, port: Path, tmp_path: Path) -> None:
    control, folder = tmp_path / "control", tmp_path / "kept"
    words = ("--control", control, "--output", "web:port=0", "--record", folder, "--filter", "hdr")
    with serving(port, *words) as (serve, device):
        address = path_of(serve, "web")
        device.send_all(csv_at_100_hz(200), never)
        page.open(address)
        page.until("document.querySelector('#read-only').innerText.includes('gyrodrift ctl PATH page')")
        assert page.run("document.querySelector('#controls').hidden") is True
        with Command("ctl", control, "page") as ctl:
            assert ctl.end() == 0
        url = json.loads(ctl.out)["url"]
        assert url.startswith(f"{address}/#token=")
        page.run(f"location.href = {json.dumps(url)}")  # in the same tab
        page.until("document.querySelector('#record').innerText === 'Stop recording'")
        assert page.run("location.href") == f"{address}/"
        page.run("document.querySelector('#zero').click()")
        page.until("document.querySelector('#events').innerText.includes('Yaw was set to 0.')")
        page.run(
            "document.querySelector('#heading').value = '270'; document.querySelector('#heading-form button').click()"
        )
        page.until("document.querySelector('#events').innerText.includes('The heading was set to 270.00°.')")
        device.send_all(csv_at_100_hz(100, rate_dps=0.0, first=200), never)
        page.until("document.querySelector('#main-name').innerText === 'Heading'")
        page.run("document.querySelector('#record').click()")
        page.until("document.querySelector('#record').innerText === 'Record'")
        page.run("document.querySelector('#calibrate').click()")
        page.until("document.querySelector('#guide-says').innerText.includes('Put the device on a firm table')")
        page.run("document.querySelector('#calibrate-cancel').click()")
        page.until("document.querySelector('#guide-says').innerText.includes('Canceled; nothing is written.')")
        page.run("document.querySelector('#calibrate-axes').click()")
        page.until("document.querySelector('#guide-says').innerText.includes('Lay the board down on each of its six')")
        device.send_all(csv_at_100_hz(100, first=300), never)
        page.until("document.querySelector('#guide-says').innerText.includes('does not send three rates')")
        assert page.text("#control-error") == ""
    (recorded,) = folder.glob("*.mcap")
    assert len(load_session(recorded).t_device_s) == 300


SENTENCES = """(async () => {
  const { plain } = await import("/controls.js");
  return ["Put it there. Press Enter to start.", "Turn it, stop at the mark, then press Enter.",
    "Go back. Press Enter when it stands there.", "u removes the last turn, q ends the calibration."].map(plain);
})()"""


def test_the_guide_names_the_buttons_of_the_page(page: Tab) -> None:
    """The keys of a terminal become buttons."""
    with live(page):
        assert page.run(SENTENCES) == [
            "Put it there. Press Begin to start.",
            "Turn it, stop at the mark, then press At the mark.",
            "Go back. Press At the mark when it stands there.",
            "Undo removes the last turn, Finish ends the calibration.",
        ]


def test_a_device_with_three_axes_has_a_calibration_of_its_own(page: Tab) -> None:
    with live(page) as outputs:
        outputs.samples([corrected(seq) for seq in range(50)])
        page.until("document.querySelector('#values dd')")
        assert page.run("document.querySelector('#calibrate-axes').hidden") is True
        outputs.samples([tilted(seq) for seq in range(50, 100)])
        page.until("!document.querySelector('#calibrate-axes').hidden")


SAVED = """new Promise((resolve) => {
  HTMLAnchorElement.prototype.click = function () {
    resolve([this.download, this.href.slice(0, 5)]);
  };
  document.querySelector(".save").click();
})"""
"""Name of the file and protocol of its address, in place of a download."""


def test_a_chart_is_saved_as_a_picture(page: Tab) -> None:
    with live(page) as outputs:
        outputs.samples([corrected(seq) for seq in range(100)])
        page.until(f"{INK % 0} > 3")
        assert page.run(SAVED) == ["Yaw, deg.png", "blob:"]


def test_yaw_stays_in_view_on_a_telephone(page: Tab) -> None:
    with hub("web:port=0") as outputs:
        address = outputs.address
        page.size(400, 800, is_phone=True)
        page.open(address)
        page.until("document.querySelector('#connection').innerText === 'Live'")
        outputs.samples([corrected(seq, yaw_deg=10.0, heading_deg=nan) for seq in range(200)])
        page.until("document.querySelector('#main-value').innerText === '10.00°'")
        page.run("window.scrollTo(0, document.body.scrollHeight)")
        page.until("window.scrollY > 300")
        top = page.run("document.querySelector('#main-value').getBoundingClientRect().top")
        assert 0.0 <= top < 200.0
        assert page.run("document.documentElement.scrollWidth") == 400
        assert page.text("#error-value") == "+0.00°"


def test_it_outlives_the_service(page: Tab, port: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as free:
        number = free.getsockname()[1]
    option = f"web:port={number}"
    with serving(port, "--output", option) as (serve, device):
        page.open(path_of(serve, "web"))
        device.send_all(csv_at_100_hz(100), never)
        page.until("document.querySelector('#values dd')")
        page.run("window.isTheSamePage = true")
        assert serve.stop() == 0
    page.until("document.querySelector('#connection').innerText.startsWith('No connection since')")
    first = page.text("#main-value")
    page.errors[:] = [error for error in page.errors if "ERR_CONNECTION_REFUSED" not in error]
    with serving(port, "--output", option) as (serve, device):
        page.until("document.querySelector('#connection').innerText === 'Live'")
        device.send_all(csv_at_100_hz(1000, rate_dps=20.0), never)
        page.until(f"document.querySelector('#main-value').innerText !== {first!r}")
        assert page.run("window.isTheSamePage")
        page.open("about:blank")
        assert serve.stop() == 0
    page.errors[:] = [error for error in page.errors if "ERR_CONNECTION_REFUSED" not in error]


def test_an_hour_is_looked_back_through_without_losing_a_spike(page: Tab) -> None:
    """The hour is drawn from no more rows than there are pixels; seconds are drawn as they came."""
    with live(page) as outputs:
        result = page.run(HISTORY)
        assert result["rows"] <= 800
        assert (result["greatest"], result["fine"], result["last"], result["holes"]) == (99, 302, 2, 1)
        assert 3600 < result["kept"] < 4500
        assert result["room"] == 1 << 17
        outputs.samples([corrected(seq) for seq in range(100)])
        page.until("document.querySelector('#values dd')")
        outputs.samples([corrected(seq) for seq in range(60_000, 60_100)])
        page.until("document.querySelector('#back').max - document.querySelector('#back').min > 590")
        page.run(LOOK_BACK)
        page.until("!document.querySelector('#live').hidden")
        assert page.text("#back-text").startswith("Until ")
        page.run("document.querySelector('#live').click()")
        page.until("document.querySelector('#live').hidden")
        page.drag("#charts .u-over", 200.0)
        page.until("!document.querySelector('#live').hidden")
        page.run("document.querySelector('#live').click()")
        page.until("document.querySelector('#live').hidden")
        page.open("about:blank")
