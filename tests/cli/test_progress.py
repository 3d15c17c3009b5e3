"""How far a long command has come: on a terminal, and nowhere else."""

import io
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import TextIO

import pyte
import pytest
from support import PATIENCE_S, Terminal, ours, quick

from gyrodrift.cli import main
from gyrodrift.io.progress import Progress
from gyrodrift.tune.choice import TotalProgress
from gyrodrift.tune.options import plans_of
from gyrodrift.tune.tuning import Plan


@pytest.fixture(scope="module")
def sessions(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two of twenty seconds."""
    folder = tmp_path_factory.mktemp("progress") / "sessions"
    words = ["--sessions", "2", "--minutes", "0.4", "--seed", "1", "--profile", "identify"]
    assert main(["simulate", "--out", str(folder), *words]) == 0
    return folder


QUICK = {
    "simulate": (["--out", "{out}/new", "--minutes", "1"], "samples"),
    "filter": (["{one}", "--out", "{out}/yaw.csv"], "samples"),
    "convert": (["{one}", "{out}/one.mcap"], "samples written"),
    "info": (["{all}"], "sessions"),
}


def words(name: str, arguments: Sequence[str], sessions: Path, out: Path) -> list[str]:
    item = sessions / "session-01.mcap"
    paths = {"one": item, "all": sessions, "many": out / "many", "out": out}
    if "{many}" in arguments:
        paths["many"].mkdir()
        for index in range(COPIES):
            shutil.copy(item, paths["many"] / f"copy-{index:03}.mcap")
    return [name, *(word.format(**paths) for word in arguments)]


@pytest.mark.parametrize("name", quick(QUICK, "filter"))
def test_quick_ones_show_a_bar_that_is_gone_in_the_end(name: str, sessions: Path, tmp_path: Path) -> None:
    arguments, what = QUICK[name]
    with Terminal(*ours(*words(name, arguments, sessions, tmp_path)), columns=120, streams=["stderr"]) as terminal:
        assert terminal.end() == 0
        assert what.encode() in terminal.sent
        assert re.search(rb"\d+/\d+", terminal.sent)
        assert " left " not in terminal.text
        assert not re.search(r"\d/\d", terminal.text)


@pytest.mark.parametrize("name", quick(QUICK, "simulate"))
def test_a_pipe_and_a_quiet_terminal_see_nothing_of_it(name: str, sessions: Path, tmp_path: Path) -> None:
    arguments, _ = QUICK[name]
    line = words(name, arguments, sessions, tmp_path)
    with Terminal(*ours(*line, "--quiet"), streams=["stderr"], environment={"FORCE_COLOR": "1"}) as terminal:
        assert terminal.end() == 0
        assert terminal.sent == b""
    again = [*line, "--force"] if name in ("simulate", "convert") else line
    environment = {"FORCE_COLOR": "1", "PATH": "/usr/bin"}
    done = subprocess.run(ours(*again), capture_output=True, text=True, check=True, env=environment)
    assert "\x1b" not in done.stderr
    assert "left" not in done.stderr


def test_a_pager_is_not_drawn_over(sessions: Path) -> None:
    """Rows that go to a terminal or into a pipe come without a bar."""
    with Terminal(*ours("filter", sessions / "session-01.mcap"), columns=200) as terminal:
        assert terminal.end() == 0
        assert b"read" not in terminal.sent
        assert b"yaw_deg" in terminal.sent


LONG = {
    "tune": ["{all}", "--out", "{out}/c.yaml", "--iterations", "60", "--jobs", "1"],
    "compare": ["{many}", "--jobs", "1"],
    "diagnose": ["{all}", "--out", "{out}/report", "--jobs", "1"],
}
LEFT_OF = {"tune": "total", "compare": "sessions", "diagnose": "total"}
"""The bar with the time left: a stage with others after it has none."""

COPIES = 60
"""Sessions of a stage that lasts longer than a loaded machine needs to draw it."""

NEXT = {"tune": "sessions read", "compare": "sessions", "diagnose": "sessions checked"}


@pytest.mark.parametrize("name", quick(LONG, "tune", "diagnose"))
def test_long_ones_show_something_before_they_load_their_packages(name: str, sessions: Path, tmp_path: Path) -> None:
    line = words(name, LONG[name], sessions, tmp_path)
    with Terminal(*ours(*line), columns=120, streams=["stderr"]) as terminal:
        terminal.until(lambda shown: "packages" in shown.text, "packages")
        terminal.until(lambda shown: NEXT[name].encode() in shown.sent, NEXT[name])
        terminal.until(lambda shown: " left " in shown.text, "time left")
        assert [row.split()[0] for row in terminal.text.splitlines() if " left " in row] == [LEFT_OF[name]]
        terminal.process.send_signal(signal.SIGINT)
        terminal.end()
        assert " left " not in terminal.text
        assert b"\x1b[?25h" in terminal.sent, "the cursor is back"


def test_no_colour_where_none_is_wanted(tmp_path: Path) -> None:
    """NO_COLOR takes them from the bars."""
    line = ours("simulate", "--out", tmp_path / "new", "--minutes", "1")
    with Terminal(*line, streams=["stderr"], environment={"NO_COLOR": "1"}) as terminal:
        assert terminal.end() == 0
        assert b"samples" in terminal.sent
        assert not re.search(rb"\x1b\[[\d;]*3[0-7][\d;]*m|\x1b\[[\d;]*38;", terminal.sent)


LOGGING = "from gyrodrift.io.log import open_log; open_log().warning('gap', missing=3, seconds=0.03)"


@pytest.mark.parametrize(
    ("environment", "is_coloured"),
    [({}, True), ({"NO_COLOR": "1"}, False), ({"NO_COLOR": ""}, True), ({"NO_COLOR": "1", "FORCE_COLOR": "1"}, True)],
)
def test_the_log_on_a_terminal_has_the_colours_that_are_wanted(
    environment: dict[str, str], *, is_coloured: bool
) -> None:
    with Terminal(sys.executable, "-c", LOGGING, environment=environment) as terminal:
        assert terminal.end() == 0
        assert "  Warning: 3 samples lost; the longest gap is 0.03 s." in terminal.text
        assert (b"\x1b[3" in terminal.sent) == is_coloured


class InterruptedAfter(io.StringIO):
    """A terminal where somebody presses Ctrl-C in the moment that `word` has been drawn."""

    def __init__(self, word: str) -> None:
        super().__init__()
        self._word: str | None = word

    def isatty(self) -> bool:
        return True

    def flush(self) -> None:
        super().flush()
        if self._word is not None and self._word in self.getvalue():
            self._word = None
            os.kill(os.getpid(), signal.SIGINT)


def two_bars(stream: TextIO) -> None:
    with Progress(stream) as progress:
        progress.report("the first", 1, 2)
        time.sleep(0.3)
        progress.report("the second", 1, 2)
        time.sleep(PATIENCE_S)


def test_an_interrupt_in_the_moment_of_drawing_leaves_no_row_behind() -> None:
    stream = InterruptedAfter("the second")
    screen = pyte.Screen(120, 24)
    with pytest.raises(KeyboardInterrupt):
        two_bars(stream)
    pyte.Stream(screen).feed(stream.getvalue().replace("\n", "\r\n"))
    assert "the second" in stream.getvalue()
    assert "".join(screen.display).strip() == ""


def reported(plans: tuple[Plan, ...], sessions: int) -> list[tuple[str, int, int]]:
    """Reports of all searches of these plans, each of one evaluation."""
    reports: list[tuple[str, int, int]] = []
    total = TotalProgress(plans, sessions, lambda stage, done, of: reports.append((stage, done, of)))
    for plan in plans:
        for search in ("seed 0", "reduced", *(f"without {number}" for number in range(sessions))):
            total.of_plan(plan)(search, 10, 10)
    return reports


def test_the_total_of_a_tuning_has_all_its_searches() -> None:
    plans = plans_of(None, 10, (0,), None, [])
    totals = [(done, of) for stage, done, of in reported(plans, sessions=3) if stage == "total"]
    assert totals[0] == (10, (1 + 3) * 5 * 10)
    assert totals[-1] == (200, 200)
    assert totals == sorted(totals)
