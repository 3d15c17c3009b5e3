"""`gyrodrift doctor` on recordings, and how it tells: JSON, a narrow terminal, a pipe, exit status."""

import json
import sys
from pathlib import Path

import pytest
from doctor_support import FAST, assert_findings, device, doctor
from support import Command, Terminal

from gyrodrift.cli import main
from gyrodrift.doctor.checks.registry import CHECKS

KEYS = ["id", "severity", "says", "do", "value", "unit"]


@pytest.fixture(scope="module")
def session(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A minute at rest, of a device whose clock is 5000 ppm fast, with a missing sample now and then."""
    folder = tmp_path_factory.mktemp("recorded")
    effects = ("--effect", "clock_drift:ppm=5000", "--effect", "sample_drop:share_percent=0.5")
    words = ("--out", folder, "--sessions", "1", "--minutes", "1", "--seed", "3", "--profile", "rest", "--quiet")
    assert main(["simulate", *map(str, words), *effects]) == 0
    (path,) = folder.glob("*.mcap")
    return path


def test_a_recording_is_looked_at_too(session: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Clock, gaps, noise and drift; nothing is said of a port."""
    status, found = doctor(capsys, session, "--sensor", "mpu-6050")
    assert status == 0
    assert_findings(
        found,
        [
            ("clock_drift", "warning", "ppm off this computer's."),
            ("clock_drift", "warning", "Every turn reads +0.5 % wrong"),
            ("gaps", "note", "Lost: "),
            ("noise", "ok", "of the MPU-6050"),
            ("drift_plain", "ok", "21 deg in a minute"),
        ],
    )
    assert found["clock_drift"]["value"] == pytest.approx(5000, abs=100)
    assert not {"port", "permission", "holder", "adapter", "baud"} & set(found)


def test_what_a_recording_kept_of_its_link_is_told(
    port: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Damage, the protocol and how full the line was; a table of other people says nothing of them."""
    out = tmp_path / "out"
    record = ("record", "--port", port, "--out", out, "--duration", "10")
    with device(port, *FAST, "--profile", "rest", "--fault", "bit_flips:per_kilobyte=5"), Command(*record) as run:
        assert run.end() == 0, run.log
    status, found = doctor(capsys, *out.glob("*.mcap"))
    assert status == 3
    assert_findings(found, [("damage", "error", "frames arrived damaged"), ("protocol", "ok", "It speaks native")])
    assert found["line_budget"]["value"] == pytest.approx(0.2, abs=0.06)
    (tmp_path / "table.csv").write_text("t_device_s,rate_dps\n" + "".join(f"{i / 10},{i % 3}\n" for i in range(300)))
    _, found = doctor(capsys, tmp_path / "table.csv")
    assert not {"damage", "restarts", "line_budget", "protocol", "jitter", "clock_drift"} & set(found)


def test_each_finding_has_the_keys_that_programs_read(session: Path) -> None:
    """One object a recording on one line; severity is that of the worst."""
    with Command("doctor", session, "--json") as run:
        assert run.end() == 0, run.log
    (line,) = run.out.splitlines()
    told = json.loads(line)
    assert (told["source"], told["severity"]) == (str(session), "warning")
    assert all(list(each) == KEYS for each in told["findings"])
    ids = [each["id"] for each in told["findings"]]
    assert ids == [check.id for check in CHECKS if check.id in ids]


@pytest.mark.parametrize(("fail_on", "status"), [("error", 0), ("warning", 3), ("note", 3)])
def test_the_status_is_that_of_the_least_severity_that_is_asked_for(
    session: Path, capsys: pytest.CaptureFixture[str], fail_on: str, status: int
) -> None:
    """A warning is none of an error."""
    assert doctor(capsys, session, "--fail-on", fail_on)[0] == status


def test_a_recording_that_is_none(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Status 4, as of every command; and 2 for a sensor that is not known."""
    assert main(["doctor", str(tmp_path / "none.mcap")]) == 4
    assert main(["doctor", "--sensor", "MPU-9999"]) == 2
    assert "MPU-6050" in capsys.readouterr().err


def test_in_a_pipe_each_finding_is_one_line(session: Path) -> None:
    """The worst first, without colours; --quiet leaves out what is as it should be."""
    with Command("doctor", session, "--quiet") as run:
        assert run.end() == 0
    first, *findings, last = run.out.splitlines()
    assert first == str(session)
    assert findings[0].startswith("! clock_drift: The device's clock runs")
    assert all(line[0] in "!·" for line in findings)
    assert last.startswith("1 warning, ")
    assert "\x1b" not in run.out


@pytest.mark.parametrize("no_color", ["", "1"])
def test_it_can_be_read_in_a_narrow_terminal(session: Path, no_color: str) -> None:
    """Sentences wrap between words, under each other."""
    words = (sys.executable, "-m", "gyrodrift", "doctor", session, "--quiet")
    with Terminal(*words, columns=40, rows=60, environment={"NO_COLOR": no_color} if no_color else {}) as terminal:
        assert terminal.end() == 0
    lines = [line.rstrip() for line in terminal.screen.display if line.strip()]
    start = next(at for at, line in enumerate(lines) if line.startswith("! clock_drift:"))
    assert lines[start] == "! clock_drift: The device's clock runs"
    assert lines[start + 1].startswith("  ")
    assert (b"\x1b[33m" in terminal.sent) == (not no_color)


def test_the_page_names_every_check() -> None:
    """docs/doctor.md has a row for each, in its words."""
    page = (Path(__file__).parent.parent.parent / "docs" / "doctor.md").read_text()
    for each in CHECKS:
        assert f"| `{each.id}` | {each.about} |" in page, each.id
