"""The threat model: each line of its table has a test that is there, and those that fit nowhere else are here."""

import re
import subprocess
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest
from support import ours

from gyrodrift.cli import parser_of
from gyrodrift.outputs.net.unix_socket import bind_unix
from gyrodrift.outputs.options import LOOPBACK
from gyrodrift.outputs.registry import OUTPUTS
from gyrodrift.session.files import write_session
from gyrodrift.session.mcap.write import McapWriter
from gyrodrift.session.session import Session

ROOT = Path(__file__).parent.parent
LINES = [
    line.split(" | ") for line in (ROOT / "docs" / "threat-model.md").read_text().splitlines() if line.startswith("| ")
][1:]
ESCAPE = "\x1b]0;mine\x07"


@pytest.mark.parametrize("line", LINES, ids=lambda line: line[0].strip("| ")[:60])
def test_each_line_has_a_test(line: list[str]) -> None:
    named = re.findall(r"`([^`]+)`", line[-1])
    assert named
    for name in named:
        if name.startswith("make "):
            assert f"\n{name.removeprefix('make ')}:" in (ROOT / "Makefile").read_text()
            continue
        file, _, test = name.partition("::")
        assert f"def {test or 'test_'}" in (ROOT / file).read_text()


@pytest.mark.parametrize("kind", OUTPUTS.values(), ids=list(OUTPUTS))
def test_outputs_are_for_this_machine_unless_asked(kind: object) -> None:
    output = getattr(kind, "output")  # noqa: B009 - the registry's own type brings every output along
    hosts = [field.default for field in fields(output.options_type) if field.name == "host"]
    assert hosts in ([], [LOOPBACK])


def test_sockets_are_for_their_user(tmp_path: Path) -> None:
    with bind_unix(tmp_path / "control"):
        assert (tmp_path / "control").stat().st_mode & 0o777 == 0o600


def test_a_cluster_is_used_only_when_asked_for() -> None:
    assert parser_of("tune").get_default("cluster") is None
    assert "## Trust" in (ROOT / "docs" / "fleet.md").read_text()


def hostile(folder: Path) -> Path:
    """Sessions whose names and words were made to hurt."""
    t_s = np.linspace(0.0, 20.0, 2001)
    session = Session("s", t_s, np.random.default_rng(1).normal(0.3, 0.05, 2001))
    for name in ("<img src=x onerror=alert(1)>", f"red{ESCAPE}", "$\\frac{"):
        write_session(folder / f"{name}.csv", [session])
    return folder


def run(*words: str | Path) -> str:
    """All that a command prints."""
    done = subprocess.run(ours(*words), capture_output=True, text=True, check=False)
    assert done.returncode in {0, 4}
    assert "Traceback" not in done.stderr
    return done.stdout + done.stderr


def test_a_terminal_gets_no_orders(tmp_path: Path) -> None:
    hostile(tmp_path)
    with (tmp_path / "note.mcap").open("wb") as file:
        writer = McapWriter(file, {"device": {"id": ESCAPE}, "recording": {"note": ESCAPE}})
        writer.add_rows(b"", 0, 0)
        writer.finish()
    (tmp_path / f"bad{ESCAPE}.csv").write_text(f"t_device_s,{ESCAPE}\n")
    statement = [run("info", path) for path in sorted(tmp_path.iterdir())]
    statement.append(run("repair", tmp_path / "note.mcap"))
    for item in statement:
        assert item
        assert "\x1b" not in item
        assert "\x07" not in item


def test_a_report_shows_names_and_runs_nothing(tmp_path: Path) -> None:
    """A name of HTML, of orders and of mathematics."""
    run("info", hostile(tmp_path), "--out", tmp_path / "page")
    page = (tmp_path / "page" / "report.html").read_text()
    assert "&lt;img src=x onerror=alert(1)&gt;" in page
    assert "<img src=x" not in page
    assert "\x1b" not in page
    run("info", tmp_path / "$\\frac{.csv", "--picture", tmp_path / "picture.png")
    assert (tmp_path / "picture.png").stat().st_size > 10_000
