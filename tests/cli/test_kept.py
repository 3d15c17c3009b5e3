"""Nothing recorded is lost by a slip: inputs are never written over, and sessions only where that is asked for."""

from pathlib import Path

import pytest

from gyrodrift.cli import main

CSV = "t_device_s,rate_dps,encoder_deg\n0,0.5,0\n0.01,0.25,0.1\n0.02,0.125,0.2\n"


@pytest.fixture
def session(tmp_path: Path) -> Path:
    path = tmp_path / "s.csv"
    path.write_text(CSV)
    return path


def spellings(path: Path) -> list[Path]:
    """Itself, through a folder and back, and by links of both kinds."""
    (path.parent / "beside").mkdir()
    soft, hard = path.with_name("soft.csv"), path.with_name("hard.csv")
    soft.symlink_to(path)
    hard.hardlink_to(path)
    return [path, path.parent / "beside" / ".." / path.name, soft, hard]


@pytest.mark.parametrize("which", range(4))
@pytest.mark.parametrize("force", [[], ["--force"]])
def test_no_command_writes_over_its_input(
    session: Path, which: int, force: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    """However the name is written, and whatever is forced."""
    target = str(spellings(session)[which])
    for words in (["filter", str(session), "--out", target], ["convert", str(session), target]):
        assert main([*words, *force]) == 2
        said = capsys.readouterr().err
        assert target in said
        assert "never written over" in said
    assert session.read_text() == CSV


def test_another_session_is_replaced_with_force_only(session: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """And named."""
    other = session.with_name("other.csv")
    for words in (["filter", str(session), "--out", str(other)], ["convert", str(session), str(other)]):
        other.write_text(CSV.replace("0.25", "0.75"))
        assert main(words) == 2
        assert f"{other}: already recorded; --force" in capsys.readouterr().err
        assert "0.75" in other.read_text()
        assert main([*words, "--force"]) == 0
        assert "0.75" not in other.read_text()


def test_what_is_no_session_is_written_anew(session: Path) -> None:
    """A filtered one, say, after the config has changed."""
    out = session.with_name("yaw.csv")
    out.write_text("t_s,yaw_deg\n0,1\n")
    assert main(["filter", str(session), "--out", str(out)]) == 0
    assert "rate_dps" in out.read_text()
    assert main(["filter", str(session), "--out", str(out)]) == 0


@pytest.mark.parametrize("ending", ["mcap", "csv"])
def test_simulated_sessions_lie_beside_recorded_ones(
    ending: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Where a name is taken nothing at all is written."""
    words = ["simulate", "--out", str(tmp_path), "--minutes", "0.05", "--format", ending]
    assert main([*words, "--sessions", "2"]) == 0
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    capsys.readouterr()
    assert main([*words, "--sessions", "5", "--seed", "1"]) == 2
    said = capsys.readouterr().err
    assert f"session-02.{ending}: already recorded; --force" in said
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before
    assert main([*words, "--sessions", "5", "--seed", "1", "--force"]) == 0
    assert len(list(tmp_path.glob(f"session-*.{ending}"))) == 5


def test_a_rig_is_not_written_over_by_sessions_of_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """With an effect more it would be another one."""
    rig = tmp_path / "rig.yaml"
    rig.write_text("base: {encoder_cpr: 4096}\n")
    words = ["simulate", "--rig", str(rig), "--out", str(tmp_path), "--minutes", "0.05", "--effect", "scale_factor"]
    assert main(words) == 2
    assert "never written over" in capsys.readouterr().err
    assert rig.read_text() == "base: {encoder_cpr: 4096}\n"


def test_hard_cases_do_not_replace_those_of_another_seed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Each has a folder of its own."""
    words = ["simulate", "--hard-cases", "--out", str(tmp_path), "--sessions", "1", "--minutes", "0.5"]
    assert main(words) == 0
    capsys.readouterr()
    assert main([*words, "--seed", "3"]) == 2
    assert "and 23 more: already recorded" in capsys.readouterr().err


def test_what_a_target_has_no_room_for_is_named_before_it_is_left_out(
    session: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Only what the session has."""
    assert main(["convert", str(session), str(session.with_suffix(".mcap")), "--as", "imu"]) == 0
    assert capsys.readouterr().err.endswith("rad/s; encoder angle does not go along\n")
