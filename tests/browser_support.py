"""A real browser for tests of pages: headless Chromium, that runs a page's script and says what became of it."""

import shutil
import subprocess
from pathlib import Path

import pytest

BROWSER = next((path for path in map(shutil.which, ("chromium", "chromium-browser", "google-chrome")) if path), None)

needs_browser = pytest.mark.skipif(BROWSER is None, reason="no Chromium here: the page's script needs a browser")

DRIVER = """<script>addEventListener("load", () => {{
const said = document.createElement("pre");
said.id = "said";
const steps = () => {{ {steps} }};
try {{ said.textContent = JSON.stringify(steps()); }} catch (error) {{ said.textContent = error.stack; }}
document.body.append(said);
}});</script>"""


def driven(html: str, steps: str, folder: Path) -> str:
    """The page as JSON or an error, whatever the steps in JavaScript return after the page has loaded."""
    page = folder / "driven.html"
    page.write_text(html.replace("</body>", f"{DRIVER.format(steps=steps)}</body>"))
    assert BROWSER is not None
    profile = f"--user-data-dir={folder / 'profile'}"
    quiet = ["--headless=new", "--no-sandbox", "--disable-gpu", "--window-size=1400,1000", profile]
    done = subprocess.run([BROWSER, *quiet, "--dump-dom", str(page)], capture_output=True, text=True, check=True)
    return done.stdout.partition('<pre id="said">')[2].partition("</pre>")[0]
