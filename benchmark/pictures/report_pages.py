"""Reports in a browser, as docs show them: each page wide and light, and beside it on a phone and dark."""

import io
import subprocess
import sys
import tempfile
from pathlib import Path

from browser_support import Tab, browsing
from PIL import Image

RIG = Path(__file__).parents[2] / "config" / "rig.yaml"
WIDE_PX, PHONE_PX, HEIGHT_PX, GAP_PX = 1000, 390, 1400, 20
COLORS = 128
"""A palette that keeps the files small; text stays sharp."""

SIMULATED = (
    ("turntable", "--minutes", "4", "--effect", "bias_instability"),
    ("identify", "--minutes", "8", "--effect", "scale_factor:error_percent=1.2"),
)
"""A shipped motion, which also names the folder of its sessions, and what differs."""

REPORTS = (
    ("info", "info", "turntable/session-01.mcap", "--out", "info"),
    ("tune", "tune", "turntable", "--out", "my.yaml", "--report", "tune", "--iterations", "600"),
    ("compare", "compare", "turntable", "--out", "compare"),
    ("diagnose", "diagnose", "identify", "--rig", str(RIG), "--out", "diagnose"),
)
"""Name of the picture and of the report's folder, then the command."""


def write(folder: Path) -> None:
    """Simulate sessions, make every report, and write its picture into the folder."""
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as work:
        for motion, *options in SIMULATED:
            run(work, "simulate", "--out", motion, "--profile", motion, "--sessions", "6", "--seed", "1", *options)
        for _, *command in REPORTS:
            run(work, *command)
        with browsing(Path(work) / "browser") as tab:
            for name, *_ in REPORTS:
                page = next((Path(work) / name).glob("*.html"))
                side_by_side(tab, page).save(folder / f"{name}.png", optimize=True)


def run(folder: str, *command: str) -> None:
    """Run a command of gyrodrift in a folder."""
    subprocess.run([sys.executable, "-m", "gyrodrift", *command, "--quiet"], cwd=folder, check=True)


def side_by_side(tab: Tab, page: Path) -> Image.Image:
    """The top of a page, wide and on a phone."""
    picture = Image.new("RGB", (WIDE_PX + GAP_PX + PHONE_PX, HEIGHT_PX), "#808080")
    picture.paste(_shot(tab, page, WIDE_PX, "light"), (0, 0))
    picture.paste(_shot(tab, page, PHONE_PX, "dark"), (WIDE_PX + GAP_PX, 0))
    return picture.quantize(COLORS)


def _shot(tab: Tab, page: Path, width_px: int, scheme: str) -> Image.Image:
    tab.size(width_px, HEIGHT_PX, is_phone=width_px == PHONE_PX)
    tab.scheme(scheme)
    tab.open(page.as_uri())
    tab.until("document.readyState === 'complete'")
    return Image.open(io.BytesIO(tab.picture()))
