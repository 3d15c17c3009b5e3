"""`gyrodrift doctor` on recordings, and how it tells: JSON, a narrow terminal, a pipe, exit status."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest
from doctor_support import assert_findings, doctor, running_device
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
    status, result = doctor(capsys, session, "--sensor", "mpu-6050")
    assert status == 0
    assert_findings(
        result,
        [
            ("clock_drift", "warning", "ppm against this computer."),
            ("clock_drift", "warning", "Every turn reads +0.5 % wrong"),
            ("gaps", "note", "Lost: "),
            ("noise", "ok", "of the MPU-6050"),
            ("drift_plain", "ok", "21 deg in a minute"),
        ],
    )
    assert result["clock_drift"]["value"] == pytest.approx(5000, abs=100)
    assert not {"port", "permission", "holder", "adapter", "baud"} & set(result)


def test_what_a_recording_kept_of_its_link_is_told(
    port: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Damage, the protocol and how full the line was; a table of other people says nothing of them."""
    out = tmp_path / "out"
    record = ("record", "--port", port, "--out", out, "--duration", "10")
    words = ("--speed", "max", "--profile", "rest", "--fault", "bit_flips:per_kilobyte=5")
    with running_device(port, *words), Command(*record) as run:
        assert run.end() == 0, run.log
    status, result = doctor(capsys, *out.glob("*.mcap"))
    assert status == 3
    assert_findings(result, [("damage", "error", "frames are damaged"), ("protocol", "ok", "It sends native")])
    assert result["line_budget"]["value"] == pytest.approx(0.2, abs=0.06)
    (tmp_path / "table.csv").write_text("t_device_s,rate_dps\n" + "".join(f"{i / 10},{i % 3}\n" for i in range(300)))
    _, result = doctor(capsys, tmp_path / "table.csv")
    assert not {"damage", "restarts", "line_budget", "protocol", "jitter", "clock_drift"} & set(result)


def test_each_finding_has_the_keys_that_programs_read(session: Path) -> None:
    with Command("doctor", session, "--json") as run:
        assert run.end() == 0, run.log
    (line,) = run.out.splitlines()
    report = json.loads(line)
    assert (report["source"], report["severity"]) == (str(session), "warning")
    assert all(list(finding) == KEYS for finding in report["findings"])
    ids = [finding["id"] for finding in report["findings"]]
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


@pytest.mark.promise("Text and units")
def test_a_recording_that_warms_is_not_called_steady(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """`doctor` does not call a warming recording steady."""
    for name, temperatures in {"slow": (25.0, 29.0, 33.0), "back": (25.0, 33.0, 25.5)}.items():
        temp_c = np.interp(np.arange(12000), [0, 6000, 12000], temperatures)
        rows = (f"{0.25 * index},{0.01 * (index % 5)},{value:.3f}\n" for index, value in enumerate(temp_c))
        (tmp_path / f"{name}.csv").write_text("t_device_s,rate_dps,temp_c\n" + "".join(rows))
    _, slow = doctor(capsys, tmp_path / "slow.csv")
    assert_findings(slow, [("temperature", "note", "25.0 to 33.0 °C within 50.0 min")])
    _, back = doctor(capsys, tmp_path / "back.csv")
    assert_findings(back, [("temperature", "note", "25.0 to 33.0 to 25.5 °C within 50.0 min")])


def test_noise_is_quoted_as_engineers_do(still_session: Path, capsys: pytest.CaptureFixture[str]) -> None:
    _, result = doctor(capsys, still_session, "--sensor", "adis16470")
    assert_findings(
        result,
        [
            ("noise", "ok", "°/√h (0.00"),
            ("noise", "ok", " deg/√s) angle random walk"),
            ("bias_instability", "ok", " °/h (0.0"),
            ("bias_instability", "ok", "the minimum of the Allan deviation over 0.664"),
            ("bias_instability", "ok", "The data sheet states 8 °/h (0.00222 deg/s)."),
        ],
    )


@pytest.fixture(scope="module")
def still_session(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Five minutes at rest with flicker noise: long enough for a minimum of the Allan deviation."""
    folder = tmp_path_factory.mktemp("still")
    words = ("--out", folder, "--minutes", "5", "--profile", "rest", "--effect", "bias_instability", "--quiet")
    assert main(["simulate", *map(str, words)]) == 0
    return folder / "session-01.mcap"


@pytest.mark.parametrize(("columns", "rows"), [(80, 24), (200, 50)])
def test_problems_and_drift_fit_on_the_screen(session: Path, columns: int, rows: int) -> None:
    """A recording with a warning: the first line and the last are on it, and a wide one is used to its end."""
    with Terminal(sys.executable, "-m", "gyrodrift", "doctor", session, columns=columns, rows=rows) as terminal:
        assert terminal.end() == 0
        lines = [line.rstrip() for line in terminal.screen.display if line.strip()]
    assert any("clock_drift" in line for line in lines)
    assert any("drift_restlevel" in line for line in lines)
    assert "not shown; --verbose shows all)" in lines[-1]
    assert max(map(len, lines)) > 0.85 * columns


def test_verbose_shows_every_finding(session: Path) -> None:
    with Command("doctor", session) as brief, Command("doctor", session, "--verbose") as verbose:
        assert (brief.end(), verbose.end()) == (0, 0)
    assert "✓ sample_rate: " in verbose.out
    assert "✓ sample_rate: " not in brief.out
    assert "✓ drift_plain: " in brief.out
    assert "--verbose" not in verbose.out


def test_in_a_pipe_each_finding_is_one_line(session: Path) -> None:
    """The worst first, without colours; --quiet leaves out what is as it should be."""
    with Command("doctor", session, "--quiet") as run:
        assert run.end() == 0
    first, *findings, last = run.out.splitlines()
    assert first == str(session)
    assert findings[0].startswith("! clock_drift: The device clock runs")
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
    start = next(position for position, line in enumerate(lines) if line.startswith("! clock_drift:"))
    assert lines[start] == "! clock_drift: The device clock runs"
    assert lines[start + 1].startswith("  ")
    assert (b"\x1b[33m" in terminal.sent) == (not no_color)


def test_the_page_names_every_check() -> None:
    """docs/doctor.md has a row for each, in its words."""
    page = (Path(__file__).parent.parent.parent / "docs" / "doctor.md").read_text()
    for item in CHECKS:
        assert f"| `{item.id}` | {item.about} |" in page, item.id
