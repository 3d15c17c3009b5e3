"""`gyrodrift compare`: tables, files, tuned rows, and every way to go wrong."""

import json
import re
from dataclasses import replace
from hashlib import sha256
from math import pi, sqrt
from pathlib import Path
from statistics import NormalDist
from typing import Any

import numpy as np
import pytest
from page_support import charts, parsed, row, words
from turntable_sessions import RATE_HZ, turntable, write_turntables

from gyrodrift.cli import main
from gyrodrift.filters.restlevel.model import RestlevelParams, RestlevelState
from gyrodrift.filters.restlevel.step import coefficients, step
from gyrodrift.io.installation import package_command
from gyrodrift.session.files import load_session, write_session

pytest.importorskip("numba", reason="comparing needs the workstation extra")
from gyrodrift.compare.methods.registry import methods

pytestmark = pytest.mark.xdist_group("restlevel_kernel")  # its compilation takes seconds


@pytest.fixture(scope="module")
def tables(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two folders of two sessions."""
    folder = tmp_path_factory.mktemp("tables")
    write_turntables(folder / "a", 2)
    write_turntables(folder / "b", 2, minutes=1.0, ending="mcap")
    return folder


@pytest.fixture(scope="module")
def notice(tables: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with what a comparison of both wrote, tuned on the second."""
    out = tmp_path_factory.mktemp("told")
    arguments = ["--train", str(tables / "b"), "--iterations", "16", "--jobs", "2", "--out", str(out)]
    assert main(["compare", str(tables / "a"), str(tables / "b"), *arguments]) == 0
    return out


@pytest.fixture(scope="module")
def by_tune(tables: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a config that `tune` found on the second folder, and what a comparison of both with it wrote."""
    folder = tmp_path_factory.mktemp("by_tune")
    arguments = ["--filter", "hdr", "--test", str(tables / "a"), "--iterations", "16", "--report", str(folder)]
    assert main(["tune", str(tables / "b"), *arguments, "--out", str(folder / "c.yaml")]) == 0
    pair = [str(tables / "a"), str(tables / "b")]
    assert main(["compare", *pair, "--config", str(folder / "c.yaml"), "--jobs", "1", "--out", str(folder)]) == 0
    return folder


def first_cells(html: str) -> list[str]:
    body = next(parsed(html).iter("tbody"))
    return [" ".join("".join(item[0].itertext()).split()) for item in body]


def numbers(folder: Path) -> dict[str, Any]:
    return dict(json.loads((folder / "compare.json").read_text()))


def of(rows: list[dict[str, Any]], key: str, *, tuned: bool = False) -> dict[str, Any]:
    return next(item for item in rows if item["method"] == key and item["tuned"] is tuned)


def installed() -> list[str]:
    """Methods that run on sessions of one axis."""
    return [
        method.key
        for method in methods()
        if method.is_installed and not (method.needs_axes or method.needs_device_yaw or method.needs_aids)
    ]


def test_the_numbers_of_plain_integration_are_those_of_its_definition(tables: Path, notice: Path) -> None:
    result: dict[str, list[tuple[float, float, float, float]]] = {"a": [], "b": []}
    for folder, ending in (("a", "csv"), ("b", "mcap")):
        for number in range(2):
            session = load_session(tables / folder / f"table-{number}.{ending}")
            assert session.encoder_deg is not None
            middles_dps = 0.5 * (session.rate_dps[1:] + session.rate_dps[:-1])
            yaw_deg = np.concatenate([[0.0], np.cumsum(middles_dps / RATE_HZ)])
            error_deg = np.abs(yaw_deg - (session.encoder_deg - session.encoder_deg[0]))
            e_deg, minutes = float(error_deg.mean()), session.t_device_s[-1] / 60.0
            result[folder].append((e_deg, e_deg / minutes, float((error_deg**2).mean()), float(error_deg.max())))
    statement = numbers(notice)
    names = ("e_deg", "ne", "pi_deg2", "worst_deg")
    sessions = [of(item["methods"], "euler") for item in statement["sessions"]]
    assert np.allclose([[item[name] for name in names] for item in sessions], [*result["a"], *result["b"]], rtol=1e-9)
    for folder in statement["folders"]:
        means = np.mean(result[folder["folder"]], axis=0)
        assert np.allclose([of(folder["methods"], "euler")[name] for name in names], means, rtol=1e-9)
    assert of(statement["methods"], "euler")["e_deg"] == pytest.approx(
        np.mean([item[0] for item in [*result["a"], *result["b"]]])
    )


def test_every_method_is_told_of_with_what_it_ran_with(notice: Path) -> None:
    """Tuned ones too, with the parameters that were found; offline ones are marked."""
    statement = numbers(notice)
    defaults = [item["method"] for item in statement["methods"] if not item["tuned"]]
    tuned = [item["method"] for item in statement["methods"] if item["tuned"]]
    assert defaults == installed()
    assert tuned == [key for key in installed() if key not in ("euler", "start")]
    assert [item["method"] for item in statement["methods"] if item["offline"]] == ["vqf_offline"] * 2
    assert of(statement["methods"], "hdr")["parameters"]["theta_w_dps"] == 0.5608
    assert of(statement["methods"], "hdr", tuned=True)["parameters"]["theta_w_dps"] != 0.5608
    assert statement["train"] == ["b/table-0", "b/table-1"]


def test_tuning_makes_no_method_worse_where_it_was_tuned(notice: Path) -> None:
    (folder,) = (item for item in numbers(notice)["folders"] if item["folder"] == "b")
    for key in (item["method"] for item in folder["methods"] if item["tuned"]):
        tuned, plain = of(folder["methods"], key, tuned=True), of(folder["methods"], key)
        assert tuned["pi_deg2"] <= plain["pi_deg2"]


def test_the_search_is_the_one_of_tune(notice: Path, by_tune: Path) -> None:
    """HDR comes out with the parameters that `tune` finds on the same sessions with the same budget."""
    tuned = json.loads((by_tune / "tune.json").read_text())["parameters"]
    assert of(numbers(notice)["methods"], "hdr", tuned=True)["parameters"] == pytest.approx(tuned, rel=1e-9)


def test_the_page_shows_all_of_it(notice: Path) -> None:
    html = (notice / "report.html").read_text()
    assert row(html, "Euler")[0] == "Euler"
    assert {"HDR, tuned ▲ tuned on 2 of these", "HDR, tuned best ▲ tuned on 2 of these"} & set(first_cells(html))
    assert "tuned rows are too optimistic: they were tuned and scored on table-0, table-1" in words(html)
    assert row(html, "a/table-1")
    assert sum(len(chart["parts"]) for chart in charts(html)) == 2 * 4 * 2, "yaw and error, twice"
    assert [item.text for item in parsed(html).iter("h2")][-1] == "Provenance"
    assert parsed(html).findtext("head/title") == "Yaw drift compared on a and b"
    assert not any(script.attrib for script in parsed(html).iter("script"))
    assert "http://" not in html.replace("http://www.w3.org", "")


def test_rows_are_sorted_and_the_best_that_streams_is_marked(notice: Path) -> None:
    statement, html = numbers(notice), (notice / "report.html").read_text()
    ranked = sorted(statement["methods"], key=lambda item: float(item["e_deg"]))
    cells = first_cells(html)
    assert [cell.partition(" ▲")[0].removesuffix(" best") for cell in cells] == [item["title"] for item in ranked]
    best = next(item for item in ranked if not item["offline"])
    assert [cell for cell in cells if "best" in cell.partition(" ▲")[0]] == [
        cell for cell in cells if cell.startswith(f"{best['title']} best")
    ]
    assert statement["best"] == best["method"]
    dots = [item for item in parsed(html).iter() if item.tag.endswith("circle")]
    assert len(dots) == 4 * len(ranked)


def test_what_restlevel_says_of_its_yaw_is_held_against_the_reference(tables: Path, notice: Path) -> None:
    """Share within two standard deviations, and CRPS, by the filter itself, sample by sample; HDR states nothing."""
    session = load_session(tables / "a" / "table-0.csv")
    assert session.encoder_deg is not None
    expected, state = coefficients(RestlevelParams()), RestlevelState()
    inside, scores = [], []
    for t_s, rate_dps, angle_deg in zip(
        session.t_device_s.tolist(), session.rate_dps.tolist(), session.encoder_deg.tolist(), strict=True
    ):
        step(expected, state, t_s, rate_dps)
        error_deg, sigma_deg = state.yaw_deg - (angle_deg - session.encoder_deg[0]), state.yaw_sigma_deg
        inside.append(abs(error_deg) <= 2.0 * sigma_deg)
        scores.append(abs(error_deg) if sigma_deg == 0.0 else crps(error_deg / sigma_deg) * sigma_deg)
    first = numbers(notice)["sessions"][0]["methods"]
    assert of(first, "restlevel")["within_2_sigma"] == pytest.approx(np.mean(inside))
    assert of(first, "restlevel")["crps_deg"] == pytest.approx(np.mean(scores), rel=1e-6)
    assert of(first, "hdr")["within_2_sigma"] is of(first, "hdr")["crps_deg"] is None


def crps(z: float) -> float:
    normal = NormalDist()
    return z * (2.0 * normal.cdf(z) - 1.0) + 2.0 * normal.pdf(z) - 1.0 / sqrt(pi)


def test_a_config_that_tune_wrote_is_told_of_with_the_sessions_that_it_saw(by_tune: Path, tables: Path) -> None:
    statement, html = numbers(by_tune), words((by_tune / "report.html").read_text())
    config = by_tune / "c.yaml"
    tuned_on = "was tuned on sessions that are scored here: table-0, table-1"
    note = f"the row HDR, by config is too optimistic: {config} {tuned_on}"
    assert statement["notes"] == [note]
    assert note in html
    assert f"HDR ran with the parameters of {config}, tuned (16 evaluations, seed 0) on 2 sessions" in html
    assert "2 of them are compared here" in html
    assert "Every other method ran with its defaults." in html
    cells = [item for item in first_cells((by_tune / "report.html").read_text()) if item.startswith("HDR")]
    (cell,) = (item for item in cells if "by config" in item)
    assert any(item.startswith("HDR, defaults") for item in cells)
    assert re.fullmatch("HDR, by config( best)? ▲ tuned on 2 of these", cell)
    hdr = of(statement["methods"], "hdr")
    assert (hdr["parameters_from"], hdr["trained_on"]) == ("config", ["table-0", "table-1"])
    assert of(statement["methods"], "restlevel")["parameters_from"] == "defaults"
    assert sha256(config.read_bytes()).hexdigest() in html
    assert "(4 sessions)" in html


def test_sessions_that_a_config_never_saw_flatter_nobody(
    by_tune: Path, tables: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["compare", str(tables / "a"), "--config", str(by_tune / "c.yaml"), "--jobs", "1"]) == 0
    report = capsys.readouterr()
    assert "none of them is compared here" in report.out
    assert "flatters" not in report.err


def test_a_rate_that_differs_from_the_one_tuned_at_is_told(
    tables: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_session(tmp_path / "odd.csv", [turntable(5, minutes=0.5, rate_hz=2.0 * RATE_HZ)])
    arguments = ["compare", str(tmp_path / "odd.csv"), "--jobs", "1"]
    assert main(arguments) == 0
    assert "sample rates differ" not in "".join(capsys.readouterr())
    assert main([*arguments, "--train", str(tables / "b"), "--iterations", "1"]) == 0
    assert "sample rates differ" in "".join(capsys.readouterr())


def test_a_table_without_tuning_says_so_and_nothing_is_written(
    tables: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Rows of methods with their means, and one row for each folder."""
    monkeypatch.chdir(tmp_path)
    assert main(["compare", str(tables / "a"), str(tables / "b"), "--jobs", "1"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("mean over 4 sessions; E, largest error and CRPS in deg")
    assert lines[1].split() == ["E", "NE", "PI", "largest", "2σ", "CRPS"]
    rows = lines[2 : 2 + len(installed())]
    errors_deg = [float(re.split(r"  +", line.lstrip("* "))[1]) for line in rows]
    assert errors_deg == sorted(errors_deg)
    assert sum(line.startswith("* ") for line in rows) == 1
    index = lines.index("mean E by folder, deg")
    assert lines[index + 1].split() == installed()
    assert [line.split()[0] for line in lines[index + 2 : index + 4]] == ["a", "b"]
    assert lines[-2:] == [
        "Every method ran with its defaults.",
        "Nothing was tuned here; --train tunes every method on other sessions.",
    ]
    assert not list(tmp_path.iterdir())


def test_a_package_that_is_missing_is_named(
    tables: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("gyrodrift.compare.methods.method.find_spec", lambda name: None if name == "vqf" else name)
    assert main(["compare", str(tables / "a"), "--jobs", "1", "--out", str(tmp_path)]) == 0
    assert f"VQF: its package vqf is not installed ({package_command('vqf')})" in capsys.readouterr().out
    statement = numbers(tmp_path)
    assert statement["missing"] == [{"method": "vqf", "package": "vqf"}, {"method": "vqf_offline", "package": "vqf"}]
    assert not any(item["method"].startswith("vqf") for item in statement["methods"])
    html = (tmp_path / "report.html").read_text()
    assert row(html, "VQF") == ["VQF", *["–"] * 6, ""]


def test_the_config_is_that_of_the_filter(tables: Path, tmp_path: Path) -> None:
    config = tmp_path / "c.yaml"
    config.write_text("hdr: {i_c_dps: 0.001, tau_s: 0.1, theta_w_dps: 3, c1: 0, c2: 1}\n")
    arguments = ["--config", str(config), "--jobs", "1", "--out", str(tmp_path)]
    assert main(["compare", str(tables / "a"), *arguments]) == 0
    assert of(numbers(tmp_path)["methods"], "hdr")["parameters"]["theta_w_dps"] == 3.0
    assert of(numbers(tmp_path)["methods"], "hdr")["e_deg"] < 2.0
    report = words((tmp_path / "report.html").read_text())
    assert f"HDR ran with the parameters of {config}, which has no provenance." in report


def test_a_still_needs_no_encoder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "still.csv"
    write_session(path, [replace(turntable(1), encoder_deg=None)])
    assert main(["compare", str(path)]) == 4
    assert f"{path}: has no encoder angle to compare yaw with; give --still if the device did not move" in (
        capsys.readouterr().err
    )
    assert main(["compare", str(path), "--still", str(path), "--jobs", "1"]) == 0


@pytest.mark.parametrize(
    ("options", "status", "message"),
    [
        (["nowhere"], 4, "nowhere: there is no such session or folder"),
        (["{a}", "--iterations", "0"], 2, "--iterations 0: expected a number above 0"),
        (["{a}", "--jobs", "-1"], 2, "--jobs -1: expected a number above 0"),
        (["{a}", "--seed", "-1"], 2, "--seed -1: expected a whole number from 0"),
        (["{a}", "--config", "nowhere.yaml"], 2, "nowhere.yaml"),
        (["{a}", "--train", "nowhere"], 4, "nowhere: there is no such session or folder"),
        (["{a}", "--out", "/dev/null/x"], 2, "/dev/null/x: cannot be written to"),
    ],
)
def test_mistakes_are_told(
    tables: Path, options: list[str], status: int, message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["compare", *(word.format(a=tables / "a") for word in options)]) == status
    report = capsys.readouterr().err
    assert message in report
    assert "Traceback" not in report


def test_the_page_begins_with_bars_and_shows_few_curves_and_one_session_large(notice: Path) -> None:
    """The other curves are shown by a click on their names."""
    html = (notice / "report.html").read_text()
    assert html.index('aria-label="Mean yaw error of every method"') < html.index("<table")
    legends = [
        [name for name in figure.iter("span") if "data-switch" in name.attrib] for figure in parsed(html).iter("figure")
    ]
    for names in filter(None, legends):
        shown = {name.attrib["data-switch"].partition("-")[0] for name in names if "data-off" not in name.attrib}
        assert "reference" in shown
        assert len(shown - {"reference", "start"}) == 2
    assert html.count('class="panel wide"') == len(list(filter(None, legends))) == 2
