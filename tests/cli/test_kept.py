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
    target = str(spellings(session)[which])
    for words in (["filter", str(session), "--out", target], ["convert", str(session), target]):
        assert main([*words, *force]) == 2
        statement = capsys.readouterr().err
        assert target in statement
        assert "never written over" in statement
    assert session.read_text() == CSV


def test_another_session_is_replaced_with_force_only(session: Path, capsys: pytest.CaptureFixture[str]) -> None:
    second = session.with_name("other.csv")
    for words in (["filter", str(session), "--out", str(second)], ["convert", str(session), str(second)]):
        second.write_text(CSV.replace("0.25", "0.75"))
        assert main(words) == 2
        assert f"{second}: already recorded; --force" in capsys.readouterr().err
        assert "0.75" in second.read_text()
        assert main([*words, "--force"]) == 0
        assert "0.75" not in second.read_text()


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
    words = ["simulate", "--out", str(tmp_path), "--minutes", "0.05", "--format", ending]
    assert main([*words, "--sessions", "2"]) == 0
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    capsys.readouterr()
    assert main([*words, "--sessions", "5", "--seed", "1"]) == 2
    statement = capsys.readouterr().err
    assert f"session-02.{ending}: already recorded; --force" in statement
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before
    assert main([*words, "--sessions", "5", "--seed", "1", "--force"]) == 0
    assert len(list(tmp_path.glob(f"session-*.{ending}"))) == 5


def test_a_rig_is_not_written_over_by_sessions_of_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rig = tmp_path / "rig.yaml"
    rig.write_text("base: {encoder_cpr: 4096}\n")
    words = ["simulate", "--rig", str(rig), "--out", str(tmp_path), "--minutes", "0.05", "--effect", "scale_factor"]
    assert main(words) == 2
    assert "never written over" in capsys.readouterr().err
    assert rig.read_text() == "base: {encoder_cpr: 4096}\n"


def test_hard_cases_do_not_replace_those_of_another_seed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["simulate", "--hard-cases", "--out", str(tmp_path), "--sessions", "1", "--minutes", "0.5"]
    assert main(words) == 0
    capsys.readouterr()
    assert main([*words, "--seed", "3"]) == 2
    assert "and 23 more: already recorded" in capsys.readouterr().err


@pytest.fixture
def places(tmp_path: Path, session: Path) -> dict[str, Path]:
    """An input of every kind, and a folder in which each name that a command writes is one of them."""
    rig, config, profile = (tmp_path / f"{name}.yaml" for name in ("a-rig", "a-config", "a-profile"))
    rig.write_text("base: {encoder_cpr: 4096}\n")
    config.write_text("filter: restlevel\n")
    profile.write_text("about: at rest\nsegments: [{kind: rest, seconds: 1}]\n")
    return {"session": session, "rig": rig, "config": config, "profile": profile, "out": tmp_path / "out"}


@pytest.mark.parametrize(
    ("words", "lost", "name"),
    [
        ("tune {session} --out {out}/my.yaml", "session", "my.yaml"),
        ("tune {session} --out {out}/my.yaml", "session", "my.progress.npz"),
        ("tune {session} --out {out}/my.yaml --report {out}", "session", "tune.json"),
        ("tune {session} --out {out}/my.yaml --report {out}", "session", "report.html"),
        ("compare {session} --out {out}", "session", "compare.json"),
        ("compare {session} --config {config} --out {out}", "config", "report.html"),
        ("diagnose {session} --rig {rig} --out {out}", "rig", "rig.yaml"),
        ("diagnose {rig} --baseline {session} --out {out}", "session", "gap.json"),
        ("info {session} --picture {out}/view.png", "session", "view.png"),
        ("demo --rig {rig} --svg {out}/view.svg", "rig", "view.svg"),
        ("demo --config {config} --svg {out}/view.svg", "config", "view.svg"),
        ("demo --profile {profile} --svg {out}/view.svg", "profile", "view.svg"),
        ("filter {session} --config {config} --out {out}/yaw.csv --force", "config", "yaw.csv"),
        ("simulate --profile {profile} --out {out} --force", "profile", "session-01.mcap"),
        ("simulate --profile {profile} --out {out} --force", "profile", "rig.yaml"),
        ("simulate --rig {rig} --out {out} --force", "rig", "rig.yaml"),
    ],
)
def test_whatever_a_command_reads_stays(
    places: dict[str, Path], words: str, lost: str, name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    before = places[lost].read_bytes()
    out = places["out"]
    for link in ("symlink_to", "hardlink_to"):
        out.mkdir(exist_ok=True)
        getattr(out / name, link)(places[lost])
        assert main(words.format(**places).split()) == 2
        statement = capsys.readouterr().err
        assert f"{out / name}: is the input {places[lost]} itself, which is never written over" in statement
        assert places[lost].read_bytes() == before
        assert (out / name).samefile(places[lost])
        (out / name).unlink()


def test_a_session_is_no_name_for_a_device(session: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for path in spellings(session):
        assert main(["replay", str(session), "--link", str(path)]) == 3
        assert f"{path} exists and is not a link to a pty" in capsys.readouterr().err
    assert session.read_text() == CSV


def test_a_table_of_other_people_is_kept_like_a_session(session: Path, capsys: pytest.CaptureFixture[str]) -> None:
    second = session.with_name("other.csv")
    second.write_text("# bench 7\n\ntime;gz\n0;1\n")
    hidden = session.with_name("recording.bak")
    assert main(["convert", str(session), str(session.with_suffix(".mcap"))]) == 0
    session.with_suffix(".mcap").rename(hidden)
    for target in (second, hidden):
        before = target.read_bytes()
        assert main(["filter", str(session), "--out", str(target)]) == 2
        assert f"{target}: already recorded; --force" in capsys.readouterr().err
        assert target.read_bytes() == before


def test_a_link_that_leads_in_a_circle_is_no_input(session: Path) -> None:
    loop = session.with_name("loop.csv")
    loop.symlink_to(loop)
    assert main(["filter", str(session), "--out", str(loop)]) == 0
    assert not loop.is_symlink()


def test_a_rig_of_other_sessions_is_not_replaced(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["simulate", "--out", str(tmp_path), "--minutes", "0.05"]
    rig = tmp_path / "rig.yaml"
    rig.write_text("base: {encoder_cpr: 4096}\n")
    assert main(words) == 2
    assert f"{rig}: differs from the rig to simulate; --force" in capsys.readouterr().err
    assert rig.read_text() == "base: {encoder_cpr: 4096}\n"
    assert main([*words, "--force"]) == 0
    assert main([*words, "--format", "csv"]) == 0


def test_a_picture_of_the_demo_is_no_other_file(session: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["demo", "--svg", str(session)]) == 2
    assert "a picture ends in .svg" in capsys.readouterr().err
    assert session.read_text() == CSV
