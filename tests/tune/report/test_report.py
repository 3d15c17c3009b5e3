"""The report of a tuning: a whole page for any tuning there can be, that says what was found and asks for nothing."""

import math
import re
from dataclasses import replace
from math import inf, nan

import numpy as np
import pytest
from page_support import charts, parsed, row, series_of, words
from tuning_support import curve, curve_of, of_e, run, score, tuning, tuning_of_both

from gyrodrift.evaluation.dataset import Split, YawCurves
from gyrodrift.evaluation.space import axes_of, linear
from gyrodrift.filters.hdr import HdrParams
from gyrodrift.filters.hdr_filter import HDR
from gyrodrift.filters.restlevel.model import RestlevelParams
from gyrodrift.filters.restlevel_filter import RESTLEVEL
from gyrodrift.report.provenance import Provenance
from gyrodrift.tune.report.charts import importances
from gyrodrift.tune.report.page import judged, report_html
from gyrodrift.tune.result import Pi, Tuning

AXES = axes_of(HDR)
MADE = Provenance("walks", "gyrodrift tune walks", "2026-01-02 03:04:05 UTC")


def test_it_begins_with_the_verdict() -> None:
    """The error on sessions that the search never saw, and what to do next."""
    html = report_html(tuning(), replace(MADE, command="gyrodrift tune <here>"))
    assert "Yaw error falls from 56.4° to 0.500° on held-out sessions" in words(html)
    assert "110 times less" in words(html)
    assert "gyrodrift serve --port PORT --config FILE.yaml" in words(html)
    assert "gyrodrift tune <here>" in words(html)
    assert "100 Hz" in words(html)


def large(html: str) -> list[str]:
    """The figures that catch the eye."""
    return ["".join(item.itertext()) for item in parsed(html).iter("dd") if item.get("class") == "main"]


def test_the_large_figure_is_the_held_out_error() -> None:
    usual = tuning()
    scores = [replace(item, tuned=of_e(0.5 if item.split is Split.TRAIN else 1.25)) for item in usual.scores]
    html = report_html(replace(usual, scores=tuple(scores)), MADE)
    assert large(html) == ["1.25°"]
    assert "Training: mean E of 2 sessions" in words(html)


def test_it_ends_with_where_it_comes_from() -> None:
    """Sessions with their hashes and uses, command, date, and the config that was found."""
    first, *rest = tuning().scores
    expected = replace(first, session=replace(first.session, digest="ab" * 32))
    html = report_html(replace(tuning(), scores=(expected, *rest)), MADE)
    assert row(html, "walk-0")
    rows = [["".join(cell.itertext()) for cell in item] for item in parsed(html).iter("tr")]
    assert ["walk-0", "training", "ab" * 32] in rows
    assert ["check-1", "test", ""] in rows
    report = words(html)
    assert "HDR tuned on walks" in (parsed(html).findtext("head/title") or "")
    for part in ("2026-01-02 03:04:05 UTC", "walks (4 sessions)", "gyrodrift tune walks", "i_c_dps: 0.000457"):
        assert part in report


def test_tables_hold_the_numbers() -> None:
    """Minutes, E and NE of both, E of the two-parameter filter; means; the cost on both splits."""
    html = report_html(tuning(), MADE)
    assert row(html, "walk-0") == ["walk-0", "20.0", "56.4", "2.82", "0.500", "0.0250", "0.750"]
    assert row(html, "check-1")[1:] == row(html, "mean")[1:] == row(html, "walk-0")[1:]
    assert row(html, "plain integration") == ["plain integration", "6877", "2008"]
    assert row(html, "tuned filter") == ["tuned filter", "0.1775", "0.2838"]
    assert row(html, "i_c_dps deg/s per sample")[1:3] == ["0.000457", "0.000001 – 0.1"]
    assert row(html, "c2")[2] == "0 – 3 at the lower bound"
    report = words(html)
    figures = re.findall(r"Figure (\d)\. \(published: Figure (\d)\)", report)
    assert figures == [("1", "6"), ("2", "7"), ("3", "8"), ("4", "9")]
    assert re.findall(r"Table (\d)\. \(published: Table (\d)\)", report) == [("1", "1"), ("3", "2"), ("4", "3")]
    assert "Table 2. The cost" in report


def test_without_test_sessions_it_says_so() -> None:
    html = report_html(tuning(train=1, test=0), MADE)
    assert "on the sessions it was tuned on" in words(html)
    assert "No sessions were held out" in words(html)
    assert "Figure 4" not in words(html)
    assert "Table 4" not in words(html)
    assert row(html, "tuned filter") == ["tuned filter", "0.1775"]
    assert large(html) == []


def test_sessions_held_out_in_turn_are_the_verdict_without_others() -> None:
    remaining = replace(tuning(test=0), cross_validation={"walk-0": of_e(1.5), "walk-1": of_e(2.5)})
    assert judged(remaining) == (56.4, 2.0, "on sessions held out in turn")
    html = report_html(remaining, MADE)
    assert "Yaw error falls from 56.4° to 2.00° on sessions held out in turn" in words(html)
    assert "Table 4. Leave-one-session-out cross-validation." in words(html)
    assert large(html) == ["2.00°"]
    assert ["walk-1", "56.4", "0.500", "2.50"] in [
        ["".join(cell.itertext()) for cell in item] for item in parsed(html).iter("tr")
    ]


def test_a_filter_that_is_worse_is_not_praised() -> None:
    worse = replace(tuning(test=0), scores=(score("walk-0", e_tuned_deg=70.0),))
    html = report_html(worse, MADE)
    assert "No gain on the sessions it was tuned on: yaw error 70.0° tuned, 56.4° by plain integration" in words(html)
    assert "keep your config" in words(html)
    assert "▲ worse" in words(html)


def test_other_seeds_show_how_far_the_numbers_spread() -> None:
    second = replace(run(7, pi=Pi(0.21, 0.19)), params=HdrParams(0.0009, 0.02, 0.2, 1.0, 2.0))
    html = report_html(replace(tuning(), other_runs=(second,)), MADE)
    assert row(html, "i_c_dps deg/s per sample")[1:3] == ["0.000457", "0.000457 – 0.0009"]
    assert row(html, "7")[:3] == ["7", "0.21", "0.19"]
    assert "over 2 seeds" in words(html)


def test_warnings_stand_before_the_numbers() -> None:
    report = words(report_html(replace(tuning(), warnings=("Two sessions are <few>.", "The rates differ.")), MADE))
    assert (
        report.index("Two sessions are <few>.")
        < report.index("The rates differ.")
        < report.index("Yaw error E is the mean")
    )


NAMES = [
    "<script>alert('&')</script>",
    'a"b' * 200,
    "Messung № 3 — 回転台\u3000👩\u200d🔬",
    "red\x1b[31m \x00 \udc80 \ufffe",
    "",
]


@pytest.mark.parametrize("name", NAMES)
def test_any_name_is_only_text(name: str) -> None:
    """Marks of HTML, letters that the figures' font has not, characters that no page may hold."""
    odd = replace(tuning(test=0), scores=(score(name),), cross_validation={name: of_e(1.0)}, method=name)
    html = report_html(odd, replace(MADE, command=name, set_name=name))
    html.encode()
    assert re.sub("[\x00\x1b\udc80\ufffe]", "\ufffd", name) in "".join(parsed(html).itertext())
    assert html.count("<script") == 2, "the page's own"


def with_curves(usual: Tuning, curves: YawCurves | None) -> Tuning:
    """Plotted for the first session alone, or for none."""
    first, *rest = usual.scores
    return replace(usual, scores=(replace(first, curves=curves), *(replace(item, curves=None) for item in rest)))


def odd_tunings() -> dict[str, Tuning]:
    """Whatever a search may end as."""
    usual = tuning()
    run_away = np.where(np.arange(90) % 3 == 0, inf, usual.run.history)
    gap = curve_of(3.0, inf)
    gap.yaw_deg[0, :9] = nan
    return {
        "no automata": replace(usual, method="de", run=replace(usual.run, densities=None)),
        "costs that are infinite": replace(usual, run=replace(usual.run, history=run_away)),
        "every cost infinite": replace(usual, run=replace(usual.run, history=np.full(90, inf), pi=Pi(inf, inf))),
        "one evaluation": replace(usual, run=run(evaluations=1)),
        "one evaluation, no automata": replace(usual, run=replace(run(evaluations=1), densities=None)),
        "a perfect fit": replace(
            usual, run=replace(usual.run, history=np.zeros(90), pi=Pi(0.0, 0.0)), reduced=Pi(0.0, 0.0)
        ),
        "no drift at all": replace(usual, euler=Pi(0.0, 0.0), scores=(score("walk-0", e_tuned_deg=0.0),)),
        "plain integration ran away": replace(usual, euler=Pi(inf, inf)),
        "a score that is infinite": replace(usual, scores=(*usual.scores, score("far", e_tuned_deg=inf))),
        "curves with holes": with_curves(usual, gap),
        "curves of nothing": with_curves(usual, curve_of(nan, inf)),
        "no curves": with_curves(usual, None),
        "a curve of one point": with_curves(usual, curve(points=1)),
        "narrow ranges": replace(usual, axes=tuple(replace(axis, low=0.4, high=0.5) for axis in AXES)),
        "linear axes": replace(usual, axes=linear(AXES), method="carla"),
        "a method of tomorrow": replace(usual, method="tomorrow"),
    }


@pytest.mark.parametrize("case", odd_tunings())
def test_whatever_a_search_ends_as_there_is_a_whole_page(case: str) -> None:
    html = report_html(odd_tunings()[case], MADE)
    assert "Figure 2." in words(html)
    assert not re.search(r"\b(nan|inf|None)\b", words(html), re.IGNORECASE)
    for chart in charts(html):
        numbers = [
            value for item in series_of(chart) for name in ("x", "y") for value in item[name] if value is not None
        ]
        assert np.isfinite([*numbers, *(part["y"][end] for part in chart["parts"] for end in ("low", "high"))]).all()


def test_it_asks_for_nothing_and_runs_its_own_script_alone() -> None:
    html = report_html(tuning(), MADE)
    scripts = list(parsed(html).iter("script"))
    assert scripts
    assert not any(script.attrib for script in scripts)
    names: list[str] = []
    references: list[str] = []
    for element in parsed(html).iter():
        assert element.tag.rpartition("}")[2] not in {"link", "img", "image", "iframe", "object"}
        for key, value in element.attrib.items():
            assert "//" not in value
            assert not key.startswith("on")
            names += [value] if key == "id" else []
            references += [value[1:]] if key.endswith("href") else re.findall(r"url\(#([^)]*)\)", value)
    assert len(names) == len(set(names)), "a name is given once"
    assert set(references) <= set(names)
    assert "@import" not in html
    assert set(re.findall(r"https?://[^\"]*", html)) <= {"http://www.w3.org/2000/svg"}


def test_every_filter_is_a_row_with_its_defaults_and_its_error_on_held_out_sessions() -> None:
    """The best one is marked, and so is the one in the config."""
    html = report_html(tuning_of_both(), MADE)
    assert row(html, "plain integration")[1:7] == ["56", "57", "–", "–", "3140", "3250"]
    assert row(html, "start calibration")[1:3] == ["0.9", "1"]
    assert row(html, "HDR, tuned in the config")[1:3] == ["0.5", "0.7"]
    assert row(html, "restlevel, defaults best")[1:3] == ["0.1", "0.2"]


def test_defaults_that_are_better_are_the_headline() -> None:
    html = report_html(replace(tuning_of_both(), is_default_written=True), MADE)
    assert "No tuned filter is better than HDR, defaults: yaw error 56.0° on held-out sessions" in words(html)
    assert "The YAML file has the defaults of the filter instead" in words(html)


def test_every_parameter_has_an_importance_and_a_slice() -> None:
    """The importance is its share of the rise of the cost along all slices."""
    shares = importances(np.array([[1.0, math.e**2, math.e**4], [2.0, 2.0, 2.0], [3.0, 3.0 * math.e**6, 3.0]]))
    assert shares == pytest.approx([0.5, 0.0, 0.5])
    html = report_html(tuning_of_both(), MADE)
    assert row(html, "tau_s s")[3] == "20 %"
    assert len(re.findall('aria-label="Cost against', html)) == len(AXES)
    assert len(re.findall('class="track"', html)) == len(AXES)


def test_charts_take_their_colours_from_the_page() -> None:
    html = report_html(tuning(), MADE)
    drawn = charts(html)
    assert len(drawn) == 1 + 5 + 4
    used = {series["color"] for chart in drawn for series in series_of(chart)}
    assert used <= set(re.findall(r"--(\w+):", html))


def test_the_same_tuning_gives_the_same_bytes() -> None:
    assert report_html(tuning(), MADE) == report_html(tuning(), MADE)


def test_many_sessions_leave_the_worst_ones_in_the_figures_and_all_in_the_tables() -> None:
    many = tuning(train=40, test=40)
    rng = np.random.default_rng(2)
    scores = tuple(
        replace(
            item,
            tuned=of_e(1.0 + number % 40),
            curves=YawCurves(np.arange(4000.0), np.zeros(4000), rng.normal(size=(2, 4000))),
        )
        for number, item in enumerate(many.scores)
    )
    html = report_html(replace(many, run=run(evaluations=20_000), scores=scores), MADE)
    assert len(html.encode()) < 3_000_000
    shown = [name.attrib["title"] for name in parsed(html).iter("b") if "title" in name.attrib]
    assert shown == [f"{kind}-{number}" for kind in ("walk", "check") for number in range(39, 27, -1)]
    assert "The 12 of 40 sessions with the largest E of the tuned filter" in words(html)
    assert "every 5th is drawn" in words(html)
    assert row(html, "walk-0")
    assert row(html, "check-39")


def test_noise_has_the_units_of_data_sheets_too() -> None:
    """The bias at power-on in °/h and its random walk in °/h/√h."""
    axes = axes_of(RESTLEVEL)
    run_of_restlevel = replace(run(), params=RestlevelParams(), cube=np.full((90, len(axes)), 0.5), densities=None)
    html = report_html(
        replace(tuning(), filter=RESTLEVEL, axes=axes, run=run_of_restlevel, reduced_params=RestlevelParams()), MADE
    )
    assert row(html, "turn_on_dps deg/s")[1] == "0.51800 °/h"
    assert row(html, "walk_dps_rts deg/s/√s")[1] == "0.0005108 °/h/√h"
