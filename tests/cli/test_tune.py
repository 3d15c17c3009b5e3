"""`gyrodrift tune`: from recorded sessions to a config that a running service takes over, and every way to go wrong."""

import json
import signal
from dataclasses import asdict, replace
from hashlib import sha256
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from support import Command, near
from turntable_sessions import RATE_HZ, turntable, write_turntables

from gyrodrift.cli import main
from gyrodrift.config.model import load_config
from gyrodrift.filters.hdr import HdrParams, HdrState, coefficients, step
from gyrodrift.firmware.my_gyro import TunedGyro, my_gyro_h
from gyrodrift.firmware.targets import gyrodrift_h
from gyrodrift.session.files import load_session, write_session
from gyrodrift.session.session import Session
from gyrodrift.tune.search import journal
from gyrodrift.tune.search.journal import Journal
from gyrodrift.values.mount import Mount

pytest.importorskip("numba", reason="tuning needs the workstation extra")

pytestmark = pytest.mark.xdist_group("restlevel_kernel")  # its compilation takes seconds


@pytest.fixture(scope="module")
def eight(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("eight")
    write_turntables(folder, 8)
    return folder


@pytest.fixture(scope="module")
def tuned(eight: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with what a tuning of the eight wrote."""
    folder = tmp_path_factory.mktemp("tuned")
    assert main(["tune", str(eight), "--out", str(folder / "c.yaml"), "--report", str(folder), *QUICK]) == 0
    return folder


QUICK = ["--filter", "hdr", "--iterations", "300", "--seed", "3"]
FEW = ["--filter", "hdr", "--iterations", "20", "--seed", "3"]
"""For what does not depend on how good the parameters are."""


def numbers(folder: Path) -> dict[str, Any]:
    return dict(json.loads((folder / "tune.json").read_text()))


def errors_deg(session: Session, params: HdrParams) -> tuple[float, float]:
    """Mean absolute and mean squared yaw error by the filter itself, sample by sample."""
    state, expected = HdrState(), coefficients(params)
    assert session.encoder_deg is not None
    result = []
    for t_s, rate_dps, angle_deg in zip(
        session.t_device_s.tolist(), session.rate_dps.tolist(), session.encoder_deg.tolist(), strict=True
    ):
        step(expected, state, t_s, rate_dps)
        result.append(state.yaw_deg - (angle_deg - session.encoder_deg[0]))
    return float(np.mean(np.abs(result))), float(np.mean(np.square(result)))


def test_the_config_is_one_that_serve_takes_and_says_where_it_is_from(eight: Path, tuned: Path) -> None:
    """Sessions with their digests, split, seed, command, PI before and after."""
    config = load_config(tuned / "c.yaml")
    assert config.sample_rate_hz == RATE_HZ
    about = yaml.safe_load((tuned / "c.yaml").read_text())["provenance"]
    assert about["command"] == f"gyrodrift tune {eight} --out {tuned}/c.yaml --report {tuned} {' '.join(QUICK)}"
    assert (about["seed"], about["iterations"], about["method"]) == (3, 300, "race")
    digests = {path.stem: sha256(path.read_bytes()).hexdigest() for path in eight.iterdir()}
    assert {item["name"]: item["sha256"] for item in about["sessions"]} == digests
    assert sorted(item["split"] for item in about["sessions"]) == ["test"] * 2 + ["train"] * 6
    assert about["pi_deg2"]["test_after"] < 0.05 * about["pi_deg2"]["test_before"]


def test_the_numbers_are_those_of_the_filter_itself(eight: Path, tuned: Path) -> None:
    """Every E, and PI as the mean over sessions of the mean squared error; Euler beside."""
    report = numbers(tuned)
    params = HdrParams(**report["parameters"])
    squares: dict[str, list[float]] = {"train": [], "test": []}
    for item in report["sessions"]:
        session = load_session(eight / f"{item['name']}.csv")
        e_deg, square = errors_deg(session, params)
        assert item["e_hdr_deg"] == pytest.approx(e_deg, rel=1e-9)
        assert item["ne_hdr"] == pytest.approx(e_deg / item["minutes"], rel=1e-9)
        assert item["minutes"] == pytest.approx(session.t_device_s[-1] / 60.0)
        assert session.encoder_deg is not None
        euler_deg = np.cumsum(session.rate_dps / RATE_HZ) - session.rate_dps[0] / RATE_HZ
        e_euler_deg = np.mean(np.abs(euler_deg - (session.encoder_deg - session.encoder_deg[0])))
        assert item["e_euler_deg"] == pytest.approx(e_euler_deg, rel=1e-9)
        squares[item["split"]].append(square)
    assert report["pi_train"] == pytest.approx(np.mean(squares["train"]), rel=1e-9)
    assert report["pi_test"] == pytest.approx(np.mean(squares["test"]), rel=1e-9)
    assert len(report["history"]) == 300
    assert min(report["history"]) == pytest.approx(report["pi_train"], rel=1e-12)
    assert report["pi_train"] < 0.01 * report["euler_pi_train"]


def test_the_report_is_one_file(eight: Path, tuned: Path) -> None:
    page = (tuned / "report.html").read_text()
    assert all(item["name"] in page for item in numbers(tuned)["sessions"])
    assert f"HDR tuned on {eight.resolve().name}" in page
    assert all(sha256(path.read_bytes()).hexdigest() in page for path in eight.iterdir())
    assert "http://" not in page.replace("http://www.w3.org", "")


def test_the_same_seed_gives_the_same_file(eight: Path, tmp_path: Path) -> None:
    out, first = tmp_path / "c.yaml", b""
    for jobs in ("1", "2"):
        assert main(["tune", str(eight), "--out", str(out), *QUICK, "--jobs", jobs]) == 0
        content = out.read_bytes().replace(f"--jobs {jobs}".encode(), b"")
        assert content == (first or content)
        first = content


def test_the_calibration_of_a_config_that_is_replaced_stays(eight: Path, tmp_path: Path) -> None:
    """The parameters are new, the device is the same."""
    out = tmp_path / "c.yaml"
    out.write_text("filter: restlevel\ncalibration:\n  date: 2026-05-01  # by hand\n  scale_ccw: 0.98\n")
    assert main(["tune", str(eight), "--out", str(out), *FEW]) == 0
    assert out.read_text().endswith("calibration:\n  date: 2026-05-01  # by hand\n  scale_ccw: 0.98\n")
    config = load_config(out)
    assert config.calibration is not None
    assert (config.filter, config.calibration.scale_ccw) == ("hdr", 0.98)


def test_the_header_has_the_parameters_and_the_calibration_of_the_config(eight: Path, tmp_path: Path) -> None:
    out, header = tmp_path / "my.yaml", tmp_path / "left_gyro.h"
    out.write_text("filter: restlevel\ncalibration:\n  date: 2026-05-01\n  scale_ccw: 0.98\n")
    for _ in range(2):
        assert main(["tune", str(eight), "--out", str(out), "--header", str(header), *FEW]) == 0
    text = header.read_text()
    assert text == my_gyro_h(TunedGyro.of_config(load_config(out), "my.yaml"), "left_gyro.h")
    assert "static const gd_calibration LEFT_GYRO_CALIBRATION =\n    {GD_R(1.0), GD_R(0.98), " in text
    params = load_config(out).params
    assert isinstance(params, HdrParams)
    assert f"{{GD_R({params.i_c_dps!r}), " in text


@pytest.mark.parametrize(
    ("name", "hint"),
    [
        ("my.txt", "a header ends in .h"),
        ("no/my.h", "there is no folder"),
        ("robot.h", "is not from gyrodrift; choose another name"),
        ("folder.h", "cannot be read: Is a directory"),
        ("gyrodrift.h", "gyrodrift.h is a header of the library or of C; choose another name"),
        ("Math.h", "Math.h is a header of the library or of C; choose another name"),
        ("renamed.h", "is not from gyrodrift; choose another name"),
    ],
)
def test_a_header_that_cannot_be_written_is_told_before_the_search(
    name: str, hint: str, eight: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A header of another origin is never replaced."""
    (tmp_path / "robot.h").write_text("#define WHEELS 2\n")
    (tmp_path / "renamed.h").write_text(gyrodrift_h())
    (tmp_path / "folder.h").mkdir()
    assert main(["tune", str(eight), "--out", str(tmp_path / "c.yaml"), "--header", str(tmp_path / name)]) == 2
    assert f"--header {tmp_path / name}: {hint}" in capsys.readouterr().err
    assert (tmp_path / "robot.h").read_text() == "#define WHEELS 2\n"


def test_axes_and_mount_of_a_config_that_is_replaced_stay(eight: Path, tmp_path: Path) -> None:
    out = tmp_path / "c.yaml"
    out.write_text("filter: restlevel\nmount:\n  up: +x\n  forward: +y\naxes: 3")
    assert main(["tune", str(eight), "--out", str(out), *FEW]) == 0
    config = load_config(out)
    assert (config.filter, config.axes, config.mount) == ("hdr", "3", Mount("+x", "+y"))


def test_of_a_few_sessions_each_is_tested_with_parameters_of_the_others(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_turntables(tmp_path / "three", 3, ending="mcap")
    (tmp_path / "three" / "rig.yaml").write_text("not a session")
    arguments = ["--out", str(tmp_path / "c.yaml"), "--report", str(tmp_path), *FEW]
    assert main(["tune", str(tmp_path / "three"), *arguments]) == 0
    report = numbers(tmp_path)
    assert set(report["left_out"]) == {"table-0", "table-1", "table-2"}
    assert report["pi_test"] is not None
    assert "3 sessions, each held out in turn" in capsys.readouterr().out


def test_sessions_are_kept_apart_by_hand(eight: Path, tmp_path: Path) -> None:
    test = eight / "table-7.csv"
    arguments = ["--test", str(test), "--out", str(tmp_path / "c.yaml"), "--report", str(tmp_path), *FEW]
    assert main(["tune", str(eight), *arguments]) == 0
    assert [item["name"] for item in numbers(tmp_path)["sessions"] if item["split"] == "test"] == ["table-7"]


@pytest.fixture(scope="module")
def pair(eight: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the files of a tuning without --filter."""
    folder = tmp_path_factory.mktemp("both")
    arguments = ["--out", str(folder / "c.yaml"), "--report", str(folder), "--iterations", "100"]
    assert main(["tune", str(eight), *arguments]) == 0
    return folder


@pytest.mark.promise("Analyses and reports")
def test_without_a_filter_both_are_tuned_and_the_better_one_on_held_out_sessions_is_written(pair: Path) -> None:
    """`tune` without `--filter` tunes both filters, and writes the filter that is best on held-out sessions."""
    report = numbers(pair)
    assert list(report["filters"]) == ["hdr", "restlevel"]
    assert all(
        {"pi_train", "pi_test", "pi_test_default", "parameters"} <= item.keys() for item in report["filters"].values()
    )
    reached = {
        (name, kind): item[kind] for name, item in report["filters"].items() for kind in ("pi_test", "pi_test_default")
    }
    name, kind = min(reached, key=lambda way: reached[way])
    config = load_config(pair / "c.yaml")
    assert (report["filter"], config.filter) == (name, name)
    assert report["parameters_from"] == ("tuning" if kind == "pi_test" else "defaults")
    assert asdict(config.params) == pytest.approx(report["parameters"])
    page = (pair / "report.html").read_text()
    assert all(row in page for row in ("start calibration", "HDR, defaults", "HDR, tuned", "restlevel, defaults"))


@pytest.mark.promise("Analyses and reports")
def test_the_config_of_a_tuning_is_not_worse_than_the_default_filter(eight: Path, pair: Path, tmp_path: Path) -> None:
    """The config of `tune` is not worse than the default filter on held-out sessions."""
    quiet = ["--jobs", "1", "--out", str(tmp_path)]
    assert main(["compare", str(eight), *quiet]) == 0
    default = {item["method"]: item["e_deg"] for item in json.loads((tmp_path / "compare.json").read_text())["methods"]}
    assert main(["compare", str(eight), "--config", str(pair / "c.yaml"), *quiet]) == 0
    tuned = {item["method"]: item["e_deg"] for item in json.loads((tmp_path / "compare.json").read_text())["methods"]}
    written = load_config(pair / "c.yaml").filter
    assert tuned[written] <= 1.02 * default["restlevel"]


def test_a_default_that_is_better_than_the_named_filter_is_a_warning(
    eight: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The named filter is written all the same."""
    arguments = [
        "--filter",
        "hdr",
        "--range",
        "i_c_dps=1e-7:2e-7",
        "--iterations",
        "20",
        "--out",
        str(tmp_path / "c.yaml"),
    ]
    assert main(["tune", str(eight), *arguments]) == 0
    assert "restlevel, defaults is better than HDR, tuned: " in capsys.readouterr().err
    assert load_config(tmp_path / "c.yaml").filter == "hdr"


def test_a_range_belongs_to_the_filter_that_has_the_parameter(
    eight: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A parameter that no filter has is refused."""
    arguments = ["--iterations", "20", "--out", str(tmp_path / "c.yaml"), "--report", str(tmp_path)]
    assert main(["tune", str(eight), "--range", "tau_s=0.5:0.6", "--range", "quiet=2:3", *arguments]) == 0
    filters = numbers(tmp_path)["filters"]
    assert 0.5 <= filters["hdr"]["parameters"]["tau_s"] <= 0.6
    assert 2.0 <= filters["restlevel"]["parameters"]["quiet"] <= 3.0
    assert main(["tune", str(eight), "--range", "taus=1:2", *arguments]) == 2
    assert "--range taus=1:2: unknown parameter taus" in capsys.readouterr().err


def test_stills_have_zero_as_their_truth(tmp_path: Path) -> None:
    """Sessions without an encoder are taken where they are said to be stills, and refused by name where not."""
    write_turntables(tmp_path / "s", 3)
    still = replace(turntable(9), encoder_deg=None, rate_dps=np.random.default_rng(1).normal(0.2, 0.05, 6000))
    write_session(tmp_path / "still.csv", [still])
    rest = [str(tmp_path / "s"), "--out", str(tmp_path / "c.yaml"), "--report", str(tmp_path), *FEW]
    assert main(["tune", *rest, "--still", str(tmp_path / "still.csv")]) == 0
    item = next(item for item in numbers(tmp_path)["sessions"] if item["name"] == "still")
    assert item["e_euler_deg"] == near(0.2 * 60.0, 0.5)
    (tmp_path / "c.yaml").unlink()
    assert main(["tune", str(tmp_path / "still.csv"), *rest]) == 4
    assert not (tmp_path / "c.yaml").exists()


def test_the_best_of_several_seeds_is_kept_and_all_are_told(eight: Path, tmp_path: Path) -> None:
    arguments = [
        "--filter",
        "hdr",
        "--seeds",
        "3",
        "--iterations",
        "100",
        "--out",
        str(tmp_path / "c.yaml"),
        "--report",
        str(tmp_path),
    ]
    assert main(["tune", str(eight), *arguments]) == 0
    report = numbers(tmp_path)
    assert {item["seed"] for item in report["seeds"]} == {0, 1, 2}
    assert report["pi_train"] == min(item["pi_train"] for item in report["seeds"])


@pytest.mark.parametrize("method", ["carla", "cma", "de", "random"])
def test_other_methods_are_there_to_compare_with(eight: Path, tmp_path: Path, method: str) -> None:
    arguments = [
        "--filter",
        "hdr",
        "--method",
        method,
        "--iterations",
        "60",
        "--out",
        str(tmp_path / "c.yaml"),
        "--report",
        str(tmp_path),
    ]
    assert main(["tune", str(eight), *arguments]) == 0
    assert numbers(tmp_path)["method"] == method


def interrupt_after_saving(monkeypatch: pytest.MonkeyPatch, saves: int) -> None:
    """Save at every turn, and send the signal of Ctrl-C after so many of them."""
    save, saved = Journal.save, count(1)

    def save_and_interrupt(self: Journal) -> None:
        save(self)
        if next(saved) == saves:
            signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(journal, "SAVE_S", 0.0)
    monkeypatch.setattr(Journal, "save", save_and_interrupt)


def test_an_interrupt_writes_the_best_so_far_and_resume_ends_as_if_nothing_had_been(
    eight: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Status 130, and then the bytes of a run that was left alone."""
    out = tmp_path / "c.yaml"
    arguments = ["tune", str(eight), "--out", str(out), "--iterations", "300", "--jobs", "1", "--method", "carla"]
    arguments += ["--filter", "hdr"]
    with monkeypatch.context() as patched:
        interrupt_after_saving(patched, saves=3)
        assert main(arguments) == 130
    assert load_config(out)
    assert "interrupted: these are the best parameters so far" in "".join(capsys.readouterr())
    interrupted = yaml.safe_load(out.read_text())["provenance"]["iterations"]
    assert 0 < interrupted < 300
    assert (tmp_path / "c.progress.npz").exists()
    assert main([*arguments, "--resume"]) == 0
    resumed = out.read_bytes()
    assert not (tmp_path / "c.progress.npz").exists()
    out.unlink()
    assert main(arguments) == 0
    assert out.read_bytes() == resumed


@pytest.mark.promise("Analyses and reports")
@pytest.mark.parametrize("saves", [2, pytest.param(6, marks=pytest.mark.evaluation)])
def test_a_tuning_of_both_filters_that_was_interrupted_resumes_to_the_same_bytes(
    eight: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, saves: int
) -> None:
    """An interrupted tuning of both filters resumes to the same bytes."""
    out = tmp_path / "c.yaml"
    arguments = ["tune", str(eight), "--out", str(out), "--iterations", "64", "--jobs", "1", "--method", "random"]
    with monkeypatch.context() as patched:
        interrupt_after_saving(patched, saves)
        assert main(arguments) == 130
    assert load_config(out)
    assert main([*arguments, "--resume"]) == 0
    resumed = out.read_bytes()
    out.unlink()
    assert main(arguments) == 0
    assert out.read_bytes() == resumed


def test_a_running_service_takes_over_what_was_tuned_on_its_own_recordings(tmp_path: Path) -> None:
    """Simulated device, record, tune, and serve's config is replaced while it runs."""
    sessions, config = tmp_path / "sessions", tmp_path / "c.yaml"
    config.write_text("hdr: {i_c_dps: 0.001, tau_s: 0.1, theta_w_dps: 1, c1: 0, c2: 1}\n")
    for seed in ("1", "2"):
        port = tmp_path / f"gyro{seed}"
        with Command(
            "--link", port, "--seed", seed, "--speed", "max", "--quiet", "--wait", module="firmware_sim"
        ) as device:
            device.until(lambda _, port=port: port.is_symlink(), "device")  # type: ignore[misc]  # bound by its default
            with Command("record", "--port", port, "--out", sessions, "--duration", "60") as record:
                assert record.end() == 0
    port = tmp_path / "gyro"
    with Command("--link", port, "--quiet", module="firmware_sim") as device:
        device.until(lambda _: port.is_symlink(), "device")
        with Command("serve", "--port", port, "--config", config) as serve:
            serve.take_lines(20)
            assert main(["tune", str(sessions), "--out", str(config), "--filter", "hdr", "--iterations", "100"]) == 0
            serve.until_log("config_applied")
            serve.take_lines(20)
            assert serve.stop() == 0
    assert "hdr.i_c_dps: 0.001 → " in serve.log
    yaw_deg = [line["yaw_deg"] for line in serve.all_lines()]
    assert np.abs(np.diff(yaw_deg)).max() < 5.0


def spoilt(folder: Path, what: str) -> list[str]:
    """Sessions with something wrong, as arguments."""
    good, bad = turntable(1), turntable(2)
    angles = bad.encoder_deg
    assert angles is not None
    match what:
        case "one sample":
            bad = Session("bad", bad.t_device_s[:1], bad.rate_dps[:1], encoder_deg=angles[:1])
        case "no encoder":
            bad = replace(bad, encoder_deg=None)
        case "no number":
            bad = replace(bad, encoder_deg=np.full(len(angles), np.nan))
        case "dead encoder":
            bad = replace(bad, encoder_deg=np.zeros(len(angles)))
        case "huge":
            good, bad = (replace(item, rate_dps=item.rate_dps * 1e300) for item in (good, bad))
    write_session(folder / "good.csv", [good])
    if what != "only one":
        write_session(folder / "bad.csv", [bad])
    return [str(folder)]


@pytest.mark.parametrize(
    ("what", "message"),
    [
        ("one sample", "bad.csv: has 1 samples with a rate and a reference; at least 2 are needed"),
        ("no encoder", "bad.csv: has no encoder angle to compare yaw with; give --still if the device did not move"),
        ("no number", "bad.csv: has 0 samples with a rate and a reference"),
        ("dead encoder", "bad.csv: its encoder never moves, but its rate shows motion"),
        ("only one", "good.csv: is the only session, so none can be held out"),
        ("huge", "bad.csv: has 0 samples with a rate and a reference"),
    ],
)
def test_sessions_that_cannot_be_used_are_told_by_name(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], what: str, message: str
) -> None:
    (tmp_path / "in").mkdir()
    arguments = ["tune", *spoilt(tmp_path / "in", what), "--out", str(tmp_path / "c.yaml"), "--iterations", "50"]
    assert main(arguments) == 4
    statement = capsys.readouterr().err
    assert message in statement
    assert len(statement.splitlines()) == 1
    assert [path.name for path in tmp_path.iterdir()] == ["in"]


@pytest.mark.parametrize(
    ("arguments", "status", "message"),
    [
        (["{empty}", "--out", "{out}"], 4, "no file in this folder ends in .mcap, .csv, "),
        (["{empty}/none", "--out", "{out}"], 4, "there is no such session or folder"),
        (["{eight}", "--out", "{empty}/x/c.yaml"], 2, "there is no folder"),
        (["{eight}", "--out", "{empty}/c.txt"], 2, "a config ends in .yaml"),
        (["{eight}", "--out", "{out}", "--range", "tau_s=2:1"], 2, "LOW must be below HIGH"),
        (["{eight}", "--out", "{out}", "--iterations", "0"], 2, "--iterations 0: expected a number above 0"),
        (["{eight}", "--out", "{out}", "--report", "{eight}/table-0.csv"], 2, "cannot be written to: File exists"),
        (["{eight}", "--test", "{eight}", "--out", "{out}"], 4, "there are no sessions to tune on"),
    ],
)
def test_mistakes_are_one_line(
    eight: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], status: int, message: str
) -> None:
    (tmp_path / "empty").mkdir()
    places = {"empty": tmp_path / "empty", "out": tmp_path / "c.yaml", "eight": eight}
    assert main(["tune", *(word.format(**places) for word in arguments)]) == status
    statement = capsys.readouterr().err
    assert message in statement
    assert len(statement.splitlines()) == 1


def test_rates_that_differ_do_not_matter_to_parameters_that_count_no_samples(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_turntables(tmp_path / "s", 1)
    write_session(tmp_path / "s" / "odd.csv", [turntable(5, rate_hz=2.0 * RATE_HZ)])
    arguments = ["--filter", "restlevel", "--iterations", "20", "--out", str(tmp_path / "c.yaml")]
    assert main(["tune", str(tmp_path / "s"), *arguments]) == 0
    assert "sample rates" not in capsys.readouterr().err


def test_what_should_be_known_before_believing_it_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Rates that differ, a parameter at its bound, parameters that are left open, encoder values missing."""
    folder = tmp_path / "s"
    write_turntables(folder, 2)
    odd = turntable(5, rate_hz=2.0 * RATE_HZ)
    assert odd.encoder_deg is not None
    angles = odd.encoder_deg.copy()
    angles[100:400] = np.nan
    write_session(folder / "odd.csv", [replace(odd, encoder_deg=angles)])
    arguments = [
        "--filter",
        "hdr",
        "--range",
        "i_c_dps=1e-7:1e-6",
        "--iterations",
        "400",
        "--out",
        str(tmp_path / "c.yaml"),
    ]
    assert main(["tune", str(folder), *arguments]) == 0
    statement = capsys.readouterr().err
    assert "odd: 2% of its encoder values are not numbers and are ignored" in statement
    assert "sample rates differ, from 50 Hz (table-0) to 100 Hz (odd)" in statement
    assert "i_c_dps is at the upper end of its range, 1e-06; widen it with --range" in statement
    params = load_config(tmp_path / "c.yaml").params
    assert isinstance(params, HdrParams)
    assert params.i_c_dps <= 1e-6
    assert "is not determined by these sessions" in statement
