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
from gyrodrift.diagnose.inference.verdict import Kind, NamedCause, Negligible
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
    """Of two sessions of a gyro that reads too much."""
    return diagnosis(SCALED)


def seen(*parts: Section | None) -> str:
    return words(page("", parts))


def cause_of(scaled: Diagnosis, in_rig: Effect | None = None, phases_deg: Sequence[float] | None = None) -> NamedCause:
    """Its cause at 0.4 %, which the rig has otherwise, or with a phase of its own in each session."""
    (named,) = scaled.verdict.causes
    phases = None if phases_deg is None else np.array(phases_deg)
    candidate = replace(named.cause.candidate, in_rig=in_rig)
    size = Parameter("error_percent", 0.4, 0.38, 0.42, "%")
    others = () if phases is None else (Parameter("phase_deg", 30.0, -180.0, 180.0, "deg"),)
    return replace(
        named,
        cause=Sized(candidate, 0.4, phases),
        effect=ScaleFactor(error_percent=0.4),
        parameters=(size, *others),
    )


def with_causes(scaled: Diagnosis, *causes: NamedCause, kind: Kind = Kind.EFFECT) -> Diagnosis:
    return replace(scaled, verdict=replace(scaled.verdict, kind=kind, causes=causes, unexplained=()))


def with_negligible(scaled: Diagnosis) -> Diagnosis:
    """Where the only thing that differs costs 0.022 degrees."""
    small = (Negligible(cause_of(scaled), 0.022),)
    return replace(scaled, verdict=replace(scaled.verdict, kind=Kind.NONE, causes=(), unexplained=(), negligible=small))


def test_contradicted_facts_come_before_the_verdict(scaled: Diagnosis) -> None:
    """Both numbers are the headline; the verdict is what there is apart from that."""
    found = replace(scaled, contradictions=(COUNTS,))
    html = page("", [verdict(found)])
    (head,) = parsed(html).iter("h1")
    assert "".join(head.itertext()) == "The rig states an encoder of 1000 counts per turn, the recordings show 4096"
    shown = words(html)
    order = [COUNTS.says, "Apart from that: the rate reads 5 % too high (scale_factor)", "What differs:"]
    assert sorted(order, key=shown.index) == order
    assert summary(found)[0] == f"contradiction of facts: {COUNTS.says}"
    assert summary(found)[1] == headline(found)


def test_a_fact_without_a_number_in_the_recordings_is_told_too(scaled: Diagnosis) -> None:
    """Rates that come in no steps."""
    none = Contradiction("dps_per_lsb", 0.00763, None, "deg/s", "the rates come in none")
    assert "The rig states rates in steps of 0.00763 deg/s, the recordings show none such" in seen(
        verdict(replace(scaled, contradictions=(none,)))
    )


def test_a_wrong_size_in_the_rig_is_told_with_both_sizes(scaled: Diagnosis) -> None:
    """In the headline, in words, in its tile, in the summary, and of the rig that is written."""
    found = with_causes(scaled, cause_of(scaled, ScaleFactor(error_percent=1.2)))
    shown = seen(verdict(found))
    assert "The rate reads 0.4 % too high (scale_factor; the rig has 1.2 %)" in shown
    assert "The rig has it with 1.2 %; the recordings show error_percent 0.4 % (95 %: 0.38 to 0.42)" in shown
    assert "in the rig so far 1.2 %" in shown
    assert cause_line(found.verdict.causes[0]).startswith(
        "scale_factor: error_percent in the rig with 1.2 %, the sessions say 0.4 % (0.38 to 0.42), probability"
    )
    assert "with scale_factor at the fitted size instead of its own" in seen(next_steps(found, Path("out")))


def test_a_free_phase_is_no_number(scaled: Diagnosis) -> None:
    """It is another one in each session."""
    found = with_causes(scaled, cause_of(scaled, phases_deg=[30.0, 200.0]))
    shown = seen(verdict(found))
    assert "a phase that is different in each session" in shown
    assert "phase_deg" not in shown
    assert "a phase of its own in each session" in cause_line(found.verdict.causes[0])


def test_what_costs_nothing_has_a_list_of_its_own(scaled: Diagnosis) -> None:
    """With its size and its cost in yaw; it is not said that nothing explains the deviations."""
    found = with_negligible(scaled)
    assert headline(found) == "none: the simulator explains these sessions, but for scale_factor, negligible in yaw"
    shown = seen(verdict(found))
    assert "Real, but negligible: scale_factor changes yaw by 0.022°" in shown
    assert "none is named" not in shown
    listed = row(page("", [negligible(found)]), "scale_factor error_percent")
    assert listed[1:] == ["0.4 %", "0.38 to 0.42", f"{found.verdict.negligible[0].cause.probability:.2f}", "0.022°",
                          "not in it"]  # fmt: skip
    assert "there is nothing to switch on" in words(report_html(found, Path("out"), Provenance()))
    assert negligible(scaled) is None


def test_a_baseline_is_told_in_the_head_and_is_no_doubt(scaled: Diagnosis) -> None:
    """Other remarks stay in the box."""
    remarks = (
        "baseline: it shows warmup already, which the rig lacks; only what is new since then is told",
        "session-01: short",
    )
    shown = seen(verdict(replace(scaled, remarks=remarks)))
    assert "Compared with a baseline." in shown
    assert "About the baseline: it shows warmup already, which the rig lacks" in shown
    assert "Limits of this result session-01: short" in shown
    assert "Compared with a baseline." not in seen(verdict(scaled))


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
    """From its typical parameters, in the words of no other effect."""
    sentences = {name: SENTENCES[name](kind.typical) for name, kind in CATALOGUE.items()}
    assert len(set(sentences.values())) == len(CATALOGUE)
    assert sentences["scale_factor"].endswith("% too high")
    assert SENTENCES["scale_factor"]({"error_percent": -0.5}) == "the rate reads 0.5 % too low"
    assert SENTENCES["clock_drift"]({"ppm": -300.0}) == "the device clock runs 300 ppm slow"


def test_the_headline_says_what_the_gyro_does(scaled: Diagnosis) -> None:
    """In text and on the page, with the figure of the rate error at the top and the cards explained."""
    found = with_causes(scaled, cause_of(scaled))
    assert headline(found) == "effect: the rate reads 0.4 % too high (scale_factor)"
    html = page("", [verdict(found)])
    assert "".join(next(parsed(html).iter("h1")).itertext()) == "The rate reads 0.4 % too high (scale_factor)"
    assert "How to read the cards." in words(html)


def test_a_deviation_is_told_with_its_direction() -> None:
    """The feature of the largest rates does not say that they are too low where they are too high."""
    assert deviation_words("reach", 3.0, "") == "the largest rates exceed those of the encoder"
    assert deviation_words("reach", -3.0, "") == "the largest rates are below those of the encoder"
    assert deviation_words("step", -3.0, "the bias jumps") == "the bias jumps"


def test_a_size_at_the_end_of_the_tried_sizes_is_a_bound(scaled: Diagnosis) -> None:
    """In the headline, the card and the summary; of a negative size the magnitude is bounded."""
    cause = cause_of(scaled)
    bound = replace(cause, parameters=(Parameter("error_percent", 2.9, 2.8, 3.0, "%", is_at_least=True),))
    found = with_causes(scaled, bound)
    assert headline(found) == "effect: the rate reads at least 2.8 % too high (scale_factor)"
    assert "error_percent at least 2.8 % possible sizes (95 %) 2.8 or more" in seen(verdict(found))
    assert "error_percent at least 2.8 %, probability" in cause_line(bound)
    low = replace(cause, parameters=(Parameter("error_percent", -2.9, -3.0, -2.8, "%", is_at_most=True),))
    assert headline(with_causes(scaled, low)) == "effect: the rate reads at least 2.8 % too low (scale_factor)"


def test_an_open_part_of_the_gap_is_in_the_headline(scaled: Diagnosis) -> None:
    """Also if no single feature deviates."""
    found = with_causes(scaled, cause_of(scaled))
    gap = replace(found.verdict.gap, shrink=0.7)
    assert headline(replace(found, verdict=replace(found.verdict, gap=gap))).endswith("; 70 % of the gap closed")


def test_a_feature_within_chance_is_no_difference(scaled: Diagnosis) -> None:
    """The verdict unknown lists its worst feature for the record; words do not call it a difference."""
    (first, *_) = scaled.verdict.where
    within = replace(first, is_beyond_chance=False)
    changed = replace(scaled.verdict, kind=Kind.UNKNOWN, causes=(), where=(within,), unexplained=(within,))
    found = replace(scaled, verdict=changed)
    assert "No single feature differs by more than chance" in seen(verdict(found))
    assert "where: in no single feature by more than chance, in many together" in summary(found)


def test_a_cause_that_is_rather_absent_is_not_switched_on(scaled: Diagnosis) -> None:
    """Tied causes may be named with a probability below 0.5; the rig waits for a decision."""
    found = with_causes(scaled, replace(cause_of(scaled), probability=0.4))
    assert "Without scale_factor : with a probability below 0.5" in seen(next_steps(found, Path("out")))


def test_no_probability_is_certain(scaled: Diagnosis) -> None:
    """Rounding makes no certainty."""
    cause = replace(cause_of(scaled), probability=0.9999)
    assert cause_line(cause).endswith("probability > 0.99")
    assert "Probability that it acts: > 0.99" in seen(verdict(with_causes(scaled, cause)))
