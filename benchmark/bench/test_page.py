"""The page in headless Chromium, which draws on the processor: frames a second that it shows, and what they cost."""

import os
from pathlib import Path

from browser_support import Tab, browsing
from outputs_support import path_of
from support import Command

from bench.harness import cpu_s, show

SECONDS = 10.0
WIDE, PHONE = (1280, 900), (360, 740)
WINDOWS = ("10", "30", "3600")
COUNT_DRAWN = """(() => {
  window.drawn = 0;
  const canvas = document.querySelector("#charts canvas");
  const clear = CanvasRenderingContext2D.prototype.clearRect;
  CanvasRenderingContext2D.prototype.clearRect = function (...at) {
    window.drawn += this.canvas === canvas;
    return clear.apply(this, at);
  };
})()"""
"""How often the first chart is drawn."""


def cpu_of(group: int) -> dict[int, float]:
    """Processor time of each process of a group so far, s."""
    pids = [int(place.name) for place in Path("/proc").iterdir() if place.name.isdigit()]
    return {pid: cpu_s(pid) for pid in pids if _group(pid) == group}


def _group(pid: int) -> int:
    try:
        return os.getpgid(pid)
    except ProcessLookupError:
        return 0


def measured(tab: Tab) -> tuple[str, str]:
    """Frames shown and charts drawn a second, and share of a core of the browser."""
    before, drawn = cpu_of(tab.group), tab.run("window.drawn")
    shown = tab.frames_shown(SECONDS)
    drawn = tab.run("window.drawn") - drawn
    cost_s = sum(value - before.get(pid, 0.0) for pid, value in cpu_of(tab.group).items())
    return f"{shown / SECONDS:.1f}, {drawn / SECONDS:.1f}", f"{cost_s / SECONDS:.0%}"


def test_frames_of_the_page(tmp_path: Path) -> None:
    """A turntable with everything drawn; an hour is drawn when it has moved, four times a second."""
    port = tmp_path / "gyro"
    rows = []
    with Command("--link", port, "--quiet", "--wait", module="firmware_sim") as device:
        device.until(lambda _: port.exists(), "port")
        options = ("--rate", "0.1", "--log-format", "json", "--output", "web:port=0")
        with Command("serve", "--port", port, *options) as serve, browsing(tmp_path / "browser") as tab:
            address = path_of(serve, "web")
            for name, size, scale in (("wide", WIDE, 1.0), ("phone, 3 pixels a pixel", PHONE, 3.0)):
                tab.size(*size, scale, is_phone=scale > 1.0)
                tab.open(address)
                tab.until("document.querySelector('#values dd')")
                tab.run(COUNT_DRAWN)
                for window in WINDOWS:
                    tab.run(f"document.querySelector('#windows [value=\"{window}\"]').click()")
                    frames, cost = measured(tab)
                    rows += [
                        (f"{name}, {window} s: frames shown, charts drawn a second", frames),
                        ("  of a core", cost),
                    ]
    load = f"{os.getloadavg()[0]:.1f} on {os.cpu_count()}"
    show("The page in headless Chromium", [*rows, ("load of the machine, 1 min", load)])
