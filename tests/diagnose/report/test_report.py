"""The report of a diagnosis: one file for a person, the verdict first, and a chart of every sign of the gap."""

import re
from collections.abc import Iterator
from dataclasses import replace
from math import nan
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest
from page_support import parsed, row, words

from firmware_sim.motion.profile import load_profile
from firmware_sim.rig import load_rig, parse_effect, with_effects
from gyrodrift.cli import main
from gyrodrift.diagnose.diagnosis import Diagnosis, DiagnosisRequest, diagnose
from gyrodrift.diagnose.features.vector import FEATURES
from gyrodrift.diagnose.inference.verdict import Deviation, Kind, SimToRealGap
from gyrodrift.session.files import load_session, write_session
from gyrodrift.simulation.sessions import write_sessions

pytest.importorskip("matplotlib", reason="pictures need the workstation extra")
from gyrodrift.diagnose.report.page import report_html

OUT = Path("out of the way")


def recorded(folder: Path, sessions: int, *effects: str) -> list[Path]:
    rig = with_effects(load_rig(None), [parse_effect(text) for text in effects])
    return list(write_sessions(rig, load_profile("identify"), folder, 4, sessions, 3.0))


@pytest.fixture(scope="module")
def scaled(tmp_path_factory: pytest.TempPathFactory) -> Diagnosis:
    """Of two short sessions of a gyro that reads too much, against a rig that does not; one effect withheld."""
    paths = recorded(tmp_path_factory.mktemp("scaled"), 2, "scale_factor:error_percent=1.2")
    return diagnose(DiagnosisRequest(paths, load_rig(None), frozenset({"popcorn"}), 1, None, lambda *_: None))


@pytest.fixture(scope="module")
def html(scaled: Diagnosis) -> str:
    return report_html(scaled, OUT, "gyrodrift diagnose <here>")


def test_it_is_one_file_that_asks_the_network_for_nothing(html: str) -> None:
    """No link, no script, and every element closed."""
    assert parsed(html) is not None
    assert not re.search(r"<(link|script|img|iframe|object)\b|@import|url\(\s*['\"]?http|\bsrc=", html)
    assert not re.search(r"href=['\"](?!#)", html)
    ids = re.findall(r' id="([^"]+)"', html)
    assert len(ids) == len(set(ids))


def test_the_verdict_comes_first(html: str, scaled: Diagnosis) -> None:
    """As one sentence, then its cause with size and probability, how far the gap shrank, and what to record next."""
    (head,) = list(parsed(html).iter("h1"))
    assert "scale_factor" in "".join(head.itertext())
    cause = next(cause for cause in scaled.verdict.causes if cause.effect.name == "scale_factor")
    order = [
        "2 sessions, 6 minutes",
        "scale_factor",
        "the rate is too large or too small by the same share",
        f"probability {cause.probability:.2f}",
    ]
    order += [
        "Cause: scale_factor",
        "error_percent",
        "closed",
        "Mean yaw error",
        "tuned on",
        "Record next.",
        scaled.next,
    ]
    order += ["Where they differ", "What the difference looks like", "Which effect it is", "How to go on"]
    said, at = words(html), -1
    for part in order:
        at = said.index(part, at + 1)


def test_every_sign_of_the_gap_has_a_row_and_a_chart(scaled: Diagnosis) -> None:
    """Whichever it is, before and after the cause was added."""
    everywhere = tuple(Deviation(one.stage, one.name, one.regime, one.says, 9.0, 0.01) for one in FEATURES)
    html = report_html(replace(scaled, verdict=replace(scaled.verdict, where=everywhere)), OUT)
    charts = ["".join(panel.itertext()) for panel in panels(html)]
    for one in FEATURES:
        assert row(html, one.says)
        assert sum(one.says in chart and f"{one.name}:" in chart and "→" in chart for chart in charts) == 1
    assert all(any(shown in chart for chart in charts) for shown in ("temperature", "angle within the turn"))
    assert sum("session-0" in chart for chart in charts) == 2


def panels(html: str) -> Iterator[ET.Element]:
    """Those in which something is drawn."""
    for one in parsed(html).iter("div"):
        if one.get("class") == "panel" and any(path.get("d") for path in one.iter("{http://www.w3.org/2000/svg}path")):
            yield one


def test_candidates_are_ranked(html: str, scaled: Diagnosis) -> None:
    """The cause above all others; what was not tried is told."""
    table = next(one for one in parsed(html).iter("table") if "takes away" in "".join(one.itertext()))
    names = ["".join(line[0].itertext()) for line in table.iter("tr")][1:]
    assert names[0] == "scale_factor named"
    assert "latency" in names
    assert "popcorn" not in names
    assert "Withheld popcorn" in re.sub(r"\s+", " ", " ".join(parsed(html).itertext()))
    smallest = scaled.detectable["scale_factor"]["error_percent"]
    assert f"{smallest:.3g}"[:4] in words(html)


def test_it_says_how_to_go_on(html: str) -> None:
    """Commands to be copied, with the rig that was written, quoted where they must be."""
    said = words(html)
    assert "gyrodrift simulate --rig 'out of the way/rig.yaml' --out 'out of the way/simulated'" in said
    assert "gyrodrift tune 'out of the way/simulated'" in said
    assert "gyrodrift diagnose <here>" in said


def test_the_same_diagnosis_gives_the_same_page(html: str, scaled: Diagnosis) -> None:
    """To the byte."""
    assert report_html(scaled, OUT, "gyrodrift diagnose <here>") == html


def test_what_could_be_said_of_a_diagnosis_is_only_text(scaled: Diagnosis) -> None:
    """Remarks and names may hold anything."""
    odd = replace(scaled, remarks=("<script>alert('&')</script> $x^$",), next="a < b")
    page = report_html(odd, Path("<out>"), "<b>")
    assert "<script>alert('&')</script> $x^$" in words(page)
    assert "a < b" in words(page)
    assert "<script" not in page


def test_numbers_that_there_are_not_are_dashes(scaled: Diagnosis) -> None:
    """Never nan or None."""
    gap = SimToRealGap(nan, nan, nan, None, None, None)
    lost = replace(scaled, verdict=replace(scaled.verdict, gap=gap, kind=Kind.UNKNOWN), detectable={})
    said = words(report_html(lost, OUT))
    assert not re.search(r"\b(nan|None|inf)\b", said)
    assert "It does not explain the recordings" in said


def test_one_bare_session_without_a_gap(tmp_path: Path) -> None:
    """Without host times, temperature and counter, from the command line: nothing is drawn that is not there."""
    (path,) = recorded(tmp_path / "whole", 1)
    bare = tmp_path / "bare.csv"
    write_session(bare, [replace(load_session(path), t_host_s=None, temp_c=None, seq=None)])
    assert main(["diagnose", str(bare), "--out", str(tmp_path / "out"), "--jobs", "1"]) == 0
    html = (tmp_path / "out" / "report.html").read_text()
    said = words(html)
    assert "one session only" in said
    assert "clock_drift: no host times" in said
    assert row(html, "1. bare")[-1] == "nothing"
    assert len(list(panels(html))) > 3
    assert not any("°C" in "".join(panel.itertext()) for panel in panels(html))
    assert f"gyrodrift diagnose {bare}" in said
