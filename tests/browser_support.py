"""A headless Chromium for tests of pages, spoken to by its DevTools protocol; they skip where there is none."""

import base64
import json
import os
import shutil
import signal
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any
from urllib.request import urlopen

import pytest
from support import PATIENCE_S
from websockets.sync.client import ClientConnection, connect

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
BROWSER = next(filter(None, map(shutil.which, NAMES)), None)
FLAGS = (
    "--headless=new",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-dev-shm-usage",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--hide-scrollbars",
    "--remote-debugging-port=0",
)
FRAMES = "disabled-by-default-devtools.timeline.frame"


class Tab:
    """One page: what it runs, what it complained of, what it asked the network for.

    errors
        Of the console, exceptions that nobody caught, and what the content security policy refused.
    requests
        Addresses of all requests, WebSockets too.
    group
        Of all processes of the browser.
    """

    def __init__(self, devtools: ClientConnection, group: int) -> None:
        self.group = group
        self.errors: list[str] = []
        self.requests: list[str] = []
        self._devtools = devtools
        self._traced: list[dict[str, Any]] = []
        self._is_tracing = False
        self._last = 0
        for domain in ("Page", "Runtime", "Log", "Network"):
            self._ask(f"{domain}.enable")

    def open(self, address: str) -> None:
        """Go to an address."""
        self._ask("Page.navigate", url=address)

    def run(self, script: str) -> Any:
        """The value of an expression in the page; a promise is waited for."""
        answer = self._ask("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in answer, answer["exceptionDetails"]
        return answer["result"].get("value")

    def until(self, script: str) -> None:
        """Wait until an expression is true; one that cannot be worked out yet is not."""
        until_s = time.monotonic() + PATIENCE_S
        while not self.run(f"(() => {{ try {{ return !!({script}) }} catch {{ return false }} }})()"):
            assert time.monotonic() < until_s, f"not in {PATIENCE_S} s: {script}; errors: {self.errors}"
            time.sleep(0.05)

    def text(self, selector: str) -> str:
        return str(self.run(f"document.querySelector({json.dumps(selector)}).innerText"))

    def size(self, width: int, height: int, scale: float = 1.0, *, is_phone: bool = False) -> None:
        self._ask(
            "Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=scale, mobile=is_phone
        )

    def scheme(self, name: str) -> None:
        """Be `light` or `dark`."""
        self._ask("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": name}])

    def drag(self, selector: str, right: float) -> None:
        """Press in the middle of an element, move so many pixels to the right, and let go."""
        x, y = self.run(
            f"(() => {{ const at = document.querySelector({json.dumps(selector)}).getBoundingClientRect();"
            "return [at.x + at.width / 2, at.y + at.height / 2]; })()"
        )
        for kind, to in (("mousePressed", x), ("mouseMoved", x + right), ("mouseReleased", x + right)):
            self._ask("Input.dispatchMouseEvent", type=kind, x=to, y=y, button="left", buttons=1, clickCount=1)

    def picture(self) -> bytes:
        """The page as a PNG."""
        return base64.b64decode(self._ask("Page.captureScreenshot", format="png")["data"])

    def paper(self) -> bytes:
        """The page as a PDF."""
        return base64.b64decode(self._ask("Page.printToPDF")["data"])

    def frames_shown(self, seconds: float) -> int:
        """How many frames the browser puts on its screen in so many seconds."""
        self._traced.clear()
        only = {"includedCategories": [FRAMES], "excludedCategories": ["*"]}
        self._ask("Tracing.start", transferMode="ReportEvents", traceConfig=only)
        self._is_tracing = True
        time.sleep(seconds)
        self._ask("Tracing.end")
        while self._is_tracing:
            self.run("0")
        return sum(item["name"] == "DrawFrame" for item in self._traced)

    def _ask(self, method: str, **parameters: Any) -> dict[str, Any]:
        self._last += 1
        self._devtools.send(json.dumps({"id": self._last, "method": method, "params": parameters}))
        while True:
            statement = json.loads(self._devtools.recv(PATIENCE_S))
            if statement.get("id") == self._last:
                assert "error" not in statement, statement
                return dict(statement["result"])
            self._hear(statement.get("method"), statement.get("params", {}))

    def _hear(self, method: str | None, about: dict[str, Any]) -> None:
        match method:
            case "Tracing.dataCollected":
                self._traced += about["value"]
            case "Tracing.tracingComplete":
                self._is_tracing = False
            case "Runtime.exceptionThrown":
                self.errors.append(str(about["exceptionDetails"].get("exception", {}).get("description", about)))
            case "Runtime.consoleAPICalled" if about["type"] in {"error", "warning", "assert"}:
                self.errors.append(str(about["args"]))
            case "Log.entryAdded" if about["entry"]["level"] in {"error", "warning"}:
                self.errors.append(about["entry"]["text"])
            case "Network.requestWillBeSent":
                self.requests.append(about["request"]["url"])
            case "Network.webSocketCreated":
                self.requests.append(about["url"])


@contextmanager
def browsing(folder: Path) -> Iterator[Tab]:
    """A browser with one empty tab, its profile in a folder of the test."""
    if BROWSER is None:
        pytest.skip("no Chromium is installed")
    process = subprocess.Popen(
        [BROWSER, *FLAGS, f"--user-data-dir={folder}", "about:blank"],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    try:
        with connect(_page_of(folder, process), max_size=None, compression=None) as devtools:
            yield Tab(devtools, process.pid)
    finally:
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()


def _page_of(folder: Path, process: subprocess.Popen[bytes]) -> str:
    until_s = time.monotonic() + 3 * PATIENCE_S
    while True:
        assert process.poll() is None, "the browser ended"
        assert time.monotonic() < until_s, "the browser does not come up"
        with suppress(OSError, ValueError, IndexError, StopIteration):
            number = (folder / "DevToolsActivePort").read_text().split()[0]
            with urlopen(f"http://127.0.0.1:{number}/json/list", timeout=PATIENCE_S) as answer:
                tabs = json.load(answer)
            return str(next(tab["webSocketDebuggerUrl"] for tab in tabs if tab["type"] == "page"))
        time.sleep(0.05)
