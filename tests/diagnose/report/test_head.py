"""The head of a report: what is wrong with the rig's facts, sizes of effects in the rig, and what costs nothing."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from diagnosis_support import SCALED, diagnosis
from page_support import parsed, row, words

from firmware_sim.effects.catalogue import CATALOGUE
from firmware_sim.effects.effect import Effect
from firmware_sim.effects.sensor_curve import ScaleFactor
from gyrodrift.diagnose.inference.parameters import Parameter
from gyrodrift.diagnose.inference.verdict import Kind, NamedCause, Negligible, withdrawn
from gyrodrift.diagnose.recording.facts import Contradiction
from gyrodrift.diagnose.report.effect_words import SENTENCES, deviation_words
from gyrodrift.diagnose.report.files import cause_line, headline, summary
from gyrodrift.diagnose.report.head import verdict
from gyrodrift.diagnose.report.page import next_steps, report_html
from gyrodrift.diagnose.report.tables import calibration, negligible
from gyrodrift.diagnose.result import BaseValue, Diagnosis
from gyrodrift.diagnose.simulate.response_table import Sized
from gyrodrift.report.page import Section, page
from gyrodrift.report.provenance import Provenance

COUNTS = Contradiction("encoder_cpr", 1000.0, 4096.0, "counts per turn", "the rig has 1000, the angles 4096")


@pytest.fixture(scope="module")
def scaled() -> Diagnosis:
    return diagnosis(SCALED)


def observed(*parts: Section | None) -> str:
    return words(page("", parts))


def cause_of(scaled: Diagnosis, in_rig: Effect | None = None, phases_deg: Sequence[float] | None = None) -> NamedCause:
    """Its cause at 0.4 %, which the rig has otherwise, or with a phase of its own in each session."""
    (named,) = scaled.verdict.causes
    phases = None if phases_deg is None else np.array(phases_deg)
    candidate = replace(named.cause.candidate, in_rig=in_rig)
    size = Parameter("error_percent", 0.4, 0.38, 0.42, "%")
    rest = () if phases is None else (Parameter("phase_deg", 30.0, -180.0, 180.0, "deg"),)
    return replace(
        named, cause=Sized(candidate, 0.4, phases), effect=ScaleFactor(error_percent=0.4), parameters=(size, *rest)
    )


def with_causes(scaled: Diagnosis, *causes: NamedCause, kind: Kind = Kind.EFFECT) -> Diagnosis:
    return replace(scaled, verdict=replace(scaled.verdict, kind=kind, causes=causes, unexplained=()))


def with_negligible(scaled: Diagnosis) -> Diagnosis:
    small = (Negligible(cause_of(scaled), 0.022),)
    return replace(scaled, verdict=replace(scaled.verdict, kind=Kind.NONE, causes=(), unexplained=(), negligible=small))


def test_contradicted_facts_come_before_the_verdict(scaled: Diagnosis) -> None:
    result = replace(scaled, contradictions=(COUNTS,))
    html = page("", [verdict(result)])
    (head,) = parsed(html).iter("h1")
    assert "".join(head.itertext()) == "The rig states an encoder of 1000 counts per turn, the recordings show 4096"
    shown = words(html)
    order = [COUNTS.says, "Apart from that: the rate reads 5 % too high (scale_factor)", "Probability that it acts:"]
    assert sorted(order, key=shown.index) == order
    assert summary(result)[0] == f"contradiction of facts: {COUNTS.says}"
    assert summary(result)[1] == headline(result)


def test_a_fact_without_a_number_in_the_recordings_is_told_too(scaled: Diagnosis) -> None:
    """Rates that come in no steps."""
    none = Contradiction("dps_per_lsb", 0.00763, None, "deg/s", "the rates come in none")
    assert "The rig states rates in steps of 0.00763 deg/s, the recordings show none such" in observed(
        verdict(replace(scaled, contradictions=(none,)))
    )


def test_a_wrong_size_in_the_rig_is_told_with_both_sizes(scaled: Diagnosis) -> None:
    result = with_causes(scaled, cause_of(scaled, ScaleFactor(error_percent=1.2)))
    shown = observed(verdict(result))
    assert "The rate reads 0.4 % too high (scale_factor; the rig has 1.2 %)" in shown
    assert "The rig has it with 1.2 %; the recordings show error_percent 0.4 % (95 %: 0.38 to 0.42)" in shown
    assert "in the rig so far 1.2 %" in shown
    assert cause_line(result.verdict.causes[0]).startswith(
        "scale_factor: error_percent in the rig with 1.2 %, the sessions say 0.4 % (0.38 to 0.42), probability"
    )
    assert "with scale_factor at the fitted size instead of its own" in observed(next_steps(result, Path("out")))


def test_a_free_phase_is_no_number(scaled: Diagnosis) -> None:
    result = with_causes(scaled, cause_of(scaled, phases_deg=[30.0, 200.0]))
    shown = observed(verdict(result))
    assert "a phase that is different in each session" in shown
    assert "phase_deg" not in shown
    assert "a phase of its own in each session" in cause_line(result.verdict.causes[0])


def test_what_costs_nothing_has_a_list_of_its_own(scaled: Diagnosis) -> None:
    result = with_negligible(scaled)
    assert headline(result) == "none: the simulator explains these sessions, but for scale_factor, negligible in yaw"
    shown = observed(verdict(result))
    assert "Real, but negligible: scale_factor changes yaw by 0.022°" in shown
    assert "none is named" not in shown
    listed = row(page("", [negligible(result)]), "scale_factor error_percent")
    assert listed[1:] == ["0.4 %", "0.38 to 0.42", f"{result.verdict.negligible[0].cause.probability:.2f}", "0.022°",
                          "not in it"]  # fmt: skip
    assert "there is nothing to switch on" in words(report_html(result, Path("out"), Provenance()))
    assert negligible(scaled) is None


def test_a_baseline_is_told_in_the_head_and_is_no_doubt(scaled: Diagnosis) -> None:
    """Other remarks stay in the box."""
    remarks = (
        "baseline: it shows warmup already, which the rig lacks; only what is new since then is told",
        "session-01: short",
    )
    shown = observed(verdict(replace(scaled, remarks=remarks)))
    assert "Compared with a baseline." in shown
    assert "About the baseline: it shows warmup already, which the rig lacks" in shown
    assert "Limits of this result session-01: short" in shown
    assert "Compared with a baseline." not in observed(verdict(scaled))


def test_calibration_is_told_in_units_and_digits_for_a_person(scaled: Diagnosis) -> None:
    """Milliseconds of the host, hundredths of a degree of the encoder, three digits of the noise."""
    values = (
        BaseValue("host_delay_s", 0.002, 0.00199999999, 0.0018, 0.0021),
        BaseValue("host_jitter_s", 0.0, None, None, None),
        BaseValue("encoder_phase_deg", 0.0, -0.0009, -0.0012, 0.0012),
        BaseValue("noise_dps_rthz", 0.0035, 0.00344391, 0.00325033, 0.00374847),
        BaseValue("sample_rate_hz", 100.0, 99.98765, 99.9, 100.1),
    )
    html = page("", [calibration(replace(scaled, calibration=values))])
    assert row(html, "delay until the host has a sample, ms host_delay_s")[1:] == ["2.00", "2.00", "1.80", "2.10"]
    assert row(html, "scatter of that delay (jitter), ms host_jitter_s")[1:] == [
        "0",
        "none seen",
        "none seen",
        "none seen",
    ]
    assert row(html, "encoder angle at the start (phase), deg encoder_phase_deg")[1:] == ["0", "0", "0", "0"]
    assert row(html, "white noise, deg/s/√Hz noise_dps_rthz")[1:] == ["0.00350", "0.00344", "0.00325", "0.00375"]
    assert row(html, "sample rate, Hz sample_rate_hz")[1:] == ["100", "100", "100", "100"]


def test_every_effect_has_a_sentence_with_its_size() -> None:
    sentences = {name: SENTENCES[name](kind.typical) for name, kind in CATALOGUE.items()}
    assert len(set(sentences.values())) == len(CATALOGUE)
    assert sentences["scale_factor"].endswith("% too high")
    assert SENTENCES["scale_factor"]({"error_percent": -0.5}) == "the rate reads 0.5 % too low"
    assert SENTENCES["clock_drift"]({"ppm": -300.0}) == "the device clock runs 300 ppm slow"


@pytest.mark.promise("Analyses and reports")
def test_the_headline_says_what_the_gyro_does(scaled: Diagnosis) -> None:
    """The headline of `diagnose` says in plain words what the gyro does, with sign and size."""
    result = with_causes(scaled, cause_of(scaled))
    assert headline(result) == "effect: the rate reads 0.4 % too high (scale_factor)"
    html = page("", [verdict(result)])
    assert "".join(next(parsed(html).iter("h1")).itertext()) == "The rate reads 0.4 % too high (scale_factor)"
    assert "How to read the cards" in words(html)


def test_a_deviation_is_told_with_its_direction() -> None:
    """The feature of the largest rates does not say that they are too low where they are too high."""
    assert deviation_words("reach", 3.0, "") == "the largest rates exceed those of the encoder"
    assert deviation_words("reach", -3.0, "") == "the largest rates are below those of the encoder"
    assert deviation_words("step", -3.0, "the bias jumps") == "the bias jumps"


@pytest.mark.promise("Analyses and reports")
def test_a_size_at_the_end_of_the_tried_sizes_is_a_bound(scaled: Diagnosis) -> None:
    """A size at the end of the tried sizes is stated as a bound."""
    cause = cause_of(scaled)
    bound = replace(cause, parameters=(Parameter("error_percent", 2.9, 2.8, 3.0, "%", is_at_least=True),))
    result = with_causes(scaled, bound)
    assert headline(result) == "effect: the rate reads at least 2.8 % too high (scale_factor)"
    assert "error at least 2.8 % possible sizes (95 %) 2.8 or more" in observed(verdict(result))
    assert "error_percent at least 2.8 %, probability" in cause_line(bound)
    low = replace(cause, parameters=(Parameter("error_percent", -2.9, -3.0, -2.8, "%", is_at_most=True),))
    assert headline(with_causes(scaled, low)) == "effect: the rate reads at least 2.8 % too low (scale_factor)"


def test_an_open_part_of_the_gap_is_in_the_headline(scaled: Diagnosis) -> None:
    result = with_causes(scaled, cause_of(scaled))
    gap = replace(result.verdict.gap, shrink=0.7)
    assert headline(replace(result, verdict=replace(result.verdict, gap=gap))).endswith("; 70 % of the gap closed")


def test_a_feature_within_chance_is_no_difference(scaled: Diagnosis) -> None:
    """The verdict unknown lists its worst feature for the record; words do not call it a difference."""
    (first, *_) = scaled.verdict.where
    within = replace(first, is_beyond_chance=False)
    changed = replace(scaled.verdict, kind=Kind.UNKNOWN, causes=(), where=(within,), unexplained=(within,))
    result = replace(scaled, verdict=changed)
    assert "No single feature differs by more than chance" in observed(verdict(result))
    assert "where: in no single feature by more than chance, in many together" in summary(result)


@pytest.mark.promise("Analyses and reports")
def test_a_cause_that_is_rather_absent_is_not_switched_on(scaled: Diagnosis) -> None:
    """A cause with a probability below 0.5 is not put into `rig.yaml`."""
    result = with_causes(scaled, replace(cause_of(scaled), probability=0.4, group_probability=0.4))
    assert "Without scale_factor : with a probability below 0.5" in observed(next_steps(result, Path("out")))


def test_a_correction_that_makes_yaw_worse_is_said_first_and_not_adopted(scaled: Diagnosis) -> None:
    impact = replace(scaled.yaw_impact, e_real_deg=1.79, e_sim_before_deg=0.25, e_sim_after_deg=4.3)
    assert impact.is_worse_with_causes
    assert not replace(impact, e_sim_after_deg=2.0).is_worse_with_causes
    tied = replace(scaled.verdict.causes[0], probability=0.45, group_probability=0.9)
    assert tied.is_adopted
    result = replace(scaled, verdict=withdrawn(scaled.verdict), yaw_impact=impact)
    assert not any(cause.is_adopted for cause in result.verdict.causes)
    sentence = "a correction makes yaw worse and is not adopted (recorded 1.79°, simulator 0.25°, corrected 4.3°)"
    assert headline(result).partition(": ")[2].startswith(sentence)


def test_no_probability_is_certain(scaled: Diagnosis) -> None:
    cause = replace(cause_of(scaled), probability=0.9999)
    assert cause_line(cause).endswith("probability > 0.99")
    assert "Probability that it acts: > 0.99" in observed(verdict(with_causes(scaled, cause)))
