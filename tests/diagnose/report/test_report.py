"""The report of a diagnosis: one file for a person, the verdict first, and a chart of every deviation."""

import json
import re
from collections.abc import Iterator
from dataclasses import replace
from math import nan
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest
from diagnosis_support import SCALED, diagnosis
from page_support import charts, parsed, row, series_of, words

from firmware_sim.rig import load_rig
from gyrodrift.diagnose.features.vector import FEATURES
from gyrodrift.diagnose.inference.gap import Deviation, SimToRealGap
from gyrodrift.diagnose.inference.halves import Halves
from gyrodrift.diagnose.inference.verdict import Kind
from gyrodrift.diagnose.report.effect_words import SIGNED
from gyrodrift.diagnose.report.features import features
from gyrodrift.diagnose.report.files import content, summary, write_files
from gyrodrift.diagnose.report.head import verdict
from gyrodrift.diagnose.report.page import report_html
from gyrodrift.diagnose.result import Diagnosis
from gyrodrift.report.page import page
from gyrodrift.report.provenance import Provenance

pytestmark = pytest.mark.xdist_group("diagnosis_report")

OUT = Path("out of the way")
MADE = Provenance("bench day 2", "gyrodrift diagnose <here>", "2026-11-22", (), "the shipped rig", "base: {}\n")


@pytest.fixture(scope="module")
def scaled() -> Diagnosis:
    return diagnosis(SCALED)


@pytest.fixture(scope="module")
def html(scaled: Diagnosis) -> str:
    return report_html(scaled, OUT, MADE)


def test_it_is_one_file_that_asks_the_network_for_nothing(html: str) -> None:
    assert parsed(html) is not None
    assert html.count("<script>") == 2
    assert not re.search(r"<(link|script |img|iframe|object)\b|@import|url\(\s*['\"]?http|\bsrc=", html)
    assert not re.search(r"href=['\"](?!#)", html)
    ids = re.findall(r' id="([^"]+)"', html)
    assert len(ids) == len(set(ids))


def test_the_verdict_comes_first(html: str, scaled: Diagnosis) -> None:
    (head,) = list(parsed(html).iter("h1"))
    assert "".join(head.itertext()).startswith("bench day 2: the rate reads 5 % too high (scale_factor)")
    cause = next(cause for cause in scaled.verdict.causes if cause.effect.name == "scale_factor")
    order = [
        "2 sessions, 6 minutes",
        "scale_factor",
        "the rate reads 5 % too high. Size:",
        f"Probability that it acts: {cause.probability:.2f}",
        "The rate error shows it. A slope is a scale error",
    ]
    order += [
        "Cause: scale_factor",
        "error 5",
        f"Sim-to-real gap on held-out sessions, RMS over {len(scaled.features)} features closed by the correction",
        "Mean absolute yaw error with one and the same filter recordings 12.5°",
        "RMS yaw error of the real sessions with a filter tuned in simulation tuned in the corrected simulator",
        "What to record next.",
        scaled.next_step,
    ]
    chapters = ["What to do next", "Where recordings and simulator differ", "What the difference looks like"]
    chapters += ["Which effect explains it", "The sessions", "Words used here", "Provenance"]
    order += [*chapters, *chapters]  # listed at first
    statement, index = words(html), -1
    for part in order:
        index = statement.index(part, index + 1)


def test_every_deviation_has_a_row_and_a_chart(scaled: Diagnosis) -> None:
    everywhere = tuple(
        Deviation(feature.stage, feature.name, feature.regime, feature.says, 9.0, 0.01) for feature in FEATURES
    )
    drawn = page("", [features(replace(scaled, verdict=replace(scaled.verdict, where=everywhere)))])
    charts = ["".join(panel.itertext()) for panel in panels(drawn)]
    first_cells = {"".join(item[0].itertext()).strip() for item in parsed(drawn).iter("tr") if len(item)}
    for feature in FEATURES:
        says = SIGNED.get(feature.name, (feature.says,))
        assert first_cells.intersection(says)
        report = [chart for chart in charts if f"{feature.name}:" in chart and "; corrected" in chart]
        assert sum(any(words in chart for words in says) for chart in report) == 1


def test_rate_errors_have_a_chart_each(html: str) -> None:
    charts = ["".join(panel.itertext()) for panel in panels(html)]
    assert all(any(shown in chart for chart in charts) for shown in ("temperature", "angle within the turn"))
    assert sum("session-0" in chart for chart in charts) == 2


def test_it_ends_with_where_it_comes_from(html: str) -> None:
    """The set, the command, and the rig as its config."""
    end = words(html).rpartition("Provenance")[2]
    order = ["Date 2026-11-22", "Version gyrodrift", "Sessions bench day 2", "the shipped rig", "<here>", "base: {}"]
    assert sorted(order, key=end.index) == order


def test_curves_are_switched_by_the_names_of_their_colours(html: str) -> None:
    """Every name has curves, and every curve a name."""
    names = set(re.findall(r'data-switch="(\w+)"', html))
    assert names == {"ink", "plain", "tuned", "two"}
    assert {series["key"] for chart in charts(html) for series in series_of(chart) if "key" in series} == names


def panels(html: str) -> Iterator[ET.Element]:
    for item in parsed(html).iter("div"):
        if item.get("class") == "panel" and any(inner.get("data-chart") for inner in item.iter("div")):
            yield item


def test_sets_of_effects_are_listed_by_their_probability(html: str, scaled: Diagnosis) -> None:
    """The cause above all others; what was not tried is told."""
    table = next(item for item in parsed(html).iter("table") if "what acts" in "".join(item.itertext()))
    first, *_ = ["".join(line[0].itertext()) for line in table.iter("tr")][1:]
    assert "scale_factor" in first
    assert "popcorn" not in "".join(table.itertext())
    assert "Left out by --withhold popcorn" in re.sub(r"\s+", " ", " ".join(parsed(html).itertext()))
    smallest = next(item.value for item in scaled.detectable if item.effect == "scale_factor")
    assert smallest == 2.0  # 16 of the log-likelihood ratio in two sessions, less 1.28 times their root of 32
    assert row(html, "scale_factor")[:3] == ["scale_factor", "2 %", "error_percent"]


def test_it_says_how_to_go_on(html: str) -> None:
    """Commands to be copied, with the rig that was written, quoted where they must be."""
    statement = words(html)
    assert "gyrodrift simulate --rig 'out of the way/rig.yaml' --out 'out of the way/simulated'" in statement
    assert "gyrodrift tune 'out of the way/simulated'" in statement
    assert "gyrodrift diagnose <here>" in statement


def test_the_same_diagnosis_gives_the_same_page(html: str, scaled: Diagnosis) -> None:
    assert report_html(scaled, OUT, MADE) == html


def test_what_could_be_said_of_a_diagnosis_is_only_text(scaled: Diagnosis) -> None:
    """Remarks and names may hold anything."""
    changed = replace(scaled, remarks=("<script>alert('&')</script> $x^$",), next_step="a < b")
    html = report_html(changed, Path("<out>"), replace(MADE, set_name="<b>"))
    assert "<script>alert('&')</script> $x^$" in words(html)
    assert "a < b" in words(html)
    assert html.count("<script") == 2
    assert "<h1>&lt;b&gt;: " in html


def test_numbers_that_there_are_not_are_dashes(scaled: Diagnosis) -> None:
    gap = SimToRealGap(nan, nan, nan, None, None, None)
    lost = replace(scaled, verdict=replace(scaled.verdict, gap=gap, kind=Kind.PARTLY), detectable=())
    statement = words(report_html(lost, OUT, MADE))
    assert not re.search(r"\b(nan|None|inf)\b", statement)
    assert "Part of the gap stays open" in statement


def test_where_there_is_no_gap_nothing_is_switched_on() -> None:
    html = report_html(diagnosis({"rate": 1.0}), OUT, MADE)
    statement = words(html)
    assert "Nowhere. The simulator was driven" in statement
    assert f"The largest deviation is {2.0**0.5:.1f} σ" in statement
    assert "corrected simulator" not in statement.replace("Corrected simulator The rig with", "")
    assert "Effects would show here from this size on" in statement
    assert "there is nothing to switch on" in statement
    assert len(list(panels(html))) == 5


def test_what_nothing_explains_is_placed_by_stage() -> None:
    statement = words(page("", [verdict(diagnosis({"temperature": 10.0}))]))
    assert "verdict: unknown" in statement
    assert "Stage of the rig where it shows, share of the deviations environment 100 %" in statement
    assert "none is named, and rig.yaml has no new effect" in statement


def test_halves_that_disagree_are_a_warning(scaled: Diagnosis) -> None:
    halves = Halves(False, "not the same on both halves of the recordings: none on sessions 1, 3")
    statement = words(page("", [verdict(replace(scaled, halves=halves))]))
    assert "the verdict is not the same on both halves of the recordings: none on sessions 1, 3" in statement


def test_files_hold_what_was_found(scaled: Diagnosis, tmp_path: Path) -> None:
    gap = replace(scaled.verdict.gap, before=nan)
    write_files(tmp_path, replace(scaled, verdict=replace(scaled.verdict, gap=gap)))
    result = json.loads((tmp_path / "gap.json").read_text())
    assert result["gap"]["before"] is None
    assert result["verdict"] == "partly"
    assert result["causes"][0]["effect"] == "scale_factor"
    assert result["detectable"]["scale_factor"] == {"error_percent": 2.0, "unit": "%"}
    assert result["untestable"] == {"clock_drift": "no host times", "temp_bias": "no temperature"}
    assert result["calibration"]["bias_dps"] == {"rig": 0.5, "data": 0.35, "low": 0.34, "high": 0.36}
    assert result["sessions"] == ["session-01", "session-02"]
    (effect,) = load_rig(tmp_path / "rig.yaml").effects
    assert effect.name == "scale_factor"


def test_the_keys_of_the_file_are_those_that_others_read(scaled: Diagnosis) -> None:
    result = content(scaled)
    assert {
        *("verdict", "causes", "where", "leftover", "gap", "yaw", "transfer", "detectable", "calibration", "next"),
        "seconds",
    } <= set(result)
    assert set(result["causes"][0]) == {
        "effect",
        "group",
        "probability",
        "group_probability",
        "gap_share",
        "parameters",
        "tied_with",
    }
    assert {"stage", "signature", "regime", "z", "share"} <= set(result["where"][0])
    assert set(result["gap"]) == {"before", "after", "floor", "shrink", "shrink_low", "shrink_high"}


def test_the_summary_is_short(scaled: Diagnosis) -> None:
    """The verdict first, what to record next last."""
    lines = summary(scaled)
    assert len(lines) <= 10
    assert lines[0].startswith("partly: the rate reads 5 % too high (scale_factor); 100 % of the gap closed; part of ")
    assert lines[-1] == f"next: {scaled.next_step}"
