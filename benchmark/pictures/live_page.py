"""Takes the pictures of the page that stand in docs/: a simulated turntable with a change of the config, and a boat.

python -m benchmark pictures.live_page docs
"""

import json
import sys
import tempfile
import time
from collections.abc import Iterable
from pathlib import Path

from browser_support import browsing
from outputs_support import path_of
from support import Command

CONFIG = Path(__file__).parent.parent / "config" / "gyrodrift.yaml"
SHOWN_S = 100.0
CHANGED_S = 45.0
HEELED_S = 40.0
WIDE, DARK, PHONE, BOAT = (1360, 1180), (1360, 860), (390, 1180), (1360, 700)


def main(folder: Path) -> None:
    """All of them."""
    take_turntable(folder)
    take_boat(folder)


def take_turntable(folder: Path) -> None:
    """Wide, dark and on a telephone."""
    with tempfile.TemporaryDirectory() as place:
        port, config = Path(place, "ttyUSB0"), Path(place, "my.yaml")
        config.write_text(CONFIG.read_text())
        with (
            Command("--link", port, "--quiet", "--wait", module="firmware_sim") as device,
            _serving(port, config, device) as serve,
        ):
            _until(serve, CHANGED_S)
            config.write_text(CONFIG.read_text().replace("window_s: 0.3 ", "window_s: 0.25 "))
            _until(serve, SHOWN_S)
            path_of(serve, "web")
            shots = (("wide", WIDE, "light"), ("dark", DARK, "dark"), ("phone", PHONE, "light"))
            _take(_address_with_buttons(config.with_name("control")), folder, shots)


def take_boat(folder: Path) -> None:
    """Three axes: the horizon, and the chart of roll and pitch."""
    motion = ("--axes", "3", "--profile", "boat")
    with tempfile.TemporaryDirectory() as place:
        port, config = Path(place, "ttyUSB0"), Path(place, "my.yaml")
        config.write_text(CONFIG.read_text())
        with (
            Command("--link", port, *motion, "--quiet", "--wait", module="firmware_sim") as device,
            _serving(port, config, device) as serve,
        ):
            _until(serve, HEELED_S)
            path_of(serve, "web")
            _take(_address_with_buttons(config.with_name("control")), folder, [("tilt", BOAT, "light")])


def _serving(port: Path, config: Path, device: Command) -> Command:
    device.until(lambda _: port.exists(), "port")
    options = ("--rate", "0.1", "--log-format", "json", "--config", config, "--control", config.with_name("control"))
    return Command("serve", "--port", port, *options, "--output", "tcp:port=0", "--output", "web:port=0")


def _address_with_buttons(control: Path) -> str:
    """Address of the page with the token that only the local user has."""
    with Command("ctl", control, "page") as ctl:
        assert ctl.end() == 0
        return str(json.loads(ctl.out)["url"])


def _until(serve: Command, device_s: float) -> None:
    """Let the service run until so much of the device's time has passed."""
    began_s = time.monotonic()
    while time.monotonic() < began_s + device_s and (not serve.out or serve.all_lines()[-1]["t_s"] < device_s):
        serve._read(1.0)


def _take(address: str, folder: Path, shots: Iterable[tuple[str, tuple[int, int], str]]) -> None:
    """Pictures by name, size and scheme."""
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile, browsing(Path(profile)) as tab:
        for name, (width, height), scheme in shots:
            tab.size(width, height, is_phone=name == "phone")
            tab.scheme(scheme)
            tab.open("about:blank")
            tab.open(address)
            tab.until("document.querySelector('#values dd') && document.querySelector('#clients td')")
            tab.run("document.querySelector('#windows button:nth-child(3)').click()")
            time.sleep(3.0)
            (folder / f"web-{name}.png").write_bytes(tab.picture())


if __name__ == "__main__":
    main(Path(sys.argv[1]))
