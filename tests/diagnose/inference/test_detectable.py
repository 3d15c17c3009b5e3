"""How small an effect would have been seen, and how the candidates rank."""

from dataclasses import replace

import numpy as np
import pytest
from gyrodrift.diagnose.inference.realisations import sure_gains
from gyrodrift.diagnose.inference.surrogate import Cause, Surrogate
from inference_support import SESSIONS, SIZES, candidate, evidence, response, row, rows

from firmware_sim.effects.catalogue import CATALOGUE
from firmware_sim.effects.effect import Effect
from gyrodrift.diagnose.inference.detectable import detectable
from gyrodrift.diagnose.inference.evidence import Response
from gyrodrift.diagnose.inference.ranking import hinted, lookalikes, ranking, would_explain
from gyrodrift.diagnose.simulate.candidate import Candidate

RATE, BOTH = response("scale_factor", {"rate": 1.0}), response("clock_drift", {"rate": 1.0, "clock_ratio": 1.0})


def test_the_smallest_size_is_the_first_that_chance_does_not_hide() -> None:
    """With chance of one sigma either way: 2.5 times ln((1 + (z ± 1)² / 4) / (1 + 1 / 4)) in each of four sessions."""
    (found,) = detectable(evidence({}, RATE))
    assert (found.effect, found.parameter, found.value, found.unit) == ("scale_factor", "error_percent", 4.0, "%")
    assert found.stage == "sensor"
    assert 2.5 * SESSIONS * np.log((1.0 + 2.0**2 / 4.0) / 1.25) < 6.0  # 3, with chance against it


def test_nine_of_ten_recordings_show_what_is_detectable() -> None:
    """Drawn anew with normal chance, and judged by what accepts a cause: 6, and half a standard error."""
    rng = np.random.default_rng(1)
    sizes = np.geomspace(0.1, 10.0, 200)
    quiet = evidence({}, response("scale_factor", {"rate": 1.0, "reach": 0.7}, sizes))
    nulls = rng.standard_normal((SESSIONS, 400, quiet.nulls.shape[-1]))
    (found,) = detectable(replace(quiet, nulls=nulls))
    assert found.value is not None
    expected = found.value * np.array([1.0, 0.7])
    shown = expected + rng.standard_normal((4000, SESSIONS, 2))
    gains = 2.5 * (np.log1p(shown**2 / 4.0) - np.log1p((shown - expected) ** 2 / 4.0)).sum(axis=-1)
    passes = gains.sum(axis=1) - 0.5 * gains.std(axis=1, ddof=1) * np.sqrt(SESSIONS) > 6.0
    assert passes.mean() == pytest.approx(0.9, abs=0.05)


def test_of_variants_the_one_that_is_seen_first_counts() -> None:
    """Wherever it stands."""
    for variants in ((0.5, 1.0), (1.0, 0.5), (0.01, 1.0)):
        responses = [response("scale_factor", {"rate": each}) for each in variants]
        assert [one.value for one in detectable(evidence({}, *responses))] == [4.0]


@pytest.mark.parametrize(("shown", "value"), [((1.0, 0.5, 0.7), 7.0), ((0.5, 1.0), 7.0), ((1.0, 0.01), None)])
def test_of_phases_the_one_that_is_seen_last_counts(shown: tuple[float, ...], value: float | None) -> None:
    """Nobody knows which it will be."""
    phases = [
        replace(one, candidate=replace(one.candidate, phase_deg=30.0 * number))
        for number, one in enumerate(response("scale_factor", {"rate": each}) for each in shown)
    ]
    assert [one.value for one in detectable(evidence({}, *phases))] == [value]


def test_what_else_is_fixed_is_said() -> None:
    """How often an angle has to jump depends on how far it does."""
    low, high = (
        replace(response("encoder_slip", {"rate": each}), candidate=jumps_of(height))
        for each, height in ((0.5, 0.1), (1.0, 0.4))
    )
    (found,) = detectable(evidence({}, low, high))
    assert (found.value, found.at) == (4.0, {"step_deg": 0.4})


def jumps_of(step_deg: float) -> Candidate:
    def make(per_hour: float) -> Effect:
        return CATALOGUE["encoder_slip"].model_validate(
            {"name": "encoder_slip", "per_hour": per_hour, "step_deg": step_deg}
        )

    return replace(candidate("encoder_slip", SIZES), parameter="per_hour", make=make)


def test_what_would_not_be_seen_at_any_size_has_none() -> None:
    """And what is no effect is not listed."""
    weak, strange = response("scale_factor", {"rate": 0.01}), Response(candidate("?moving"), BOTH.mean, BOTH.spread)
    assert [(one.effect, one.value) for one in detectable(evidence({}, weak, strange))] == [("scale_factor", None)]


def walk(*shown: float) -> Response:
    """Random in its size: realisations show it by so many times the mean, which is one sigma at size 1."""
    sizes = SIZES[:, None, None]
    mean = rows({"walk_20s": 1.0})
    spread = float(np.std(shown)) * row({"walk_20s": 1.0})
    realised = sizes[..., None] * np.array(shown)[:, None] * mean[:, None]
    whole = response("bias_instability", {"walk_20s": 1.0})
    return Response(candidate("bias_instability", SIZES, 4), whole.mean, SIZES[:, None] * spread, realised=realised)


def test_of_what_is_random_nine_of_ten_devices_would_have_shown_the_size() -> None:
    """One that is the same each time shows as soon as one that is not random; one that comes and goes does not."""
    steady, fickle = (
        detectable(evidence({}, one))[0].value for one in (walk(1.0, 1.0, 1.0, 1.0), walk(2.0, 2.0, 0.0, 0.0))
    )
    assert steady == pytest.approx(4.0, abs=1.0)
    assert steady is not None
    assert fickle is None or fickle > steady


def test_gains_are_those_of_realisations_beside_chance() -> None:
    """Worked out one by one for a single session, the least but for one in ten."""
    alone = Response(
        candidate("bias_instability", SIZES[:1], 4),
        rows({"walk_20s": 3.0}, 1)[None],
        row({"walk_20s": 1.0})[None],
        realised=(np.array([1.0, 3.0, 4.0, 6.0])[:, None] * row({"walk_20s": 1.0}))[None, None],
    )
    gains = [
        2.5 * (np.log1p(shown**2 / 4.0) - np.log1p((shown - 3.0) ** 2 / (4.0 * 2.0))) - 0.5 * np.log(2.0)
        for shown in (0.0, 2.0, 2.0, 4.0, 3.0, 5.0, 5.0, 7.0)
    ]
    (found,) = sure_gains(evidence(rows({}, 1), alone), alone)
    assert found == pytest.approx(min(gains))  # one of eight is more than one of ten


def test_a_size_below_zero_counts_by_its_amount() -> None:
    """A scale that is 4 % too small is as large as one that is too large."""
    below = response("scale_factor", {"rate": 1.0}, -SIZES[::-1])
    assert detectable(evidence({}, below))[0].value == 4.0


def test_candidates_are_ranked_by_what_they_gain_alone() -> None:
    """The cause that was found has nothing to gain beside itself, and the other next to nothing."""
    first, second = ranking(Surrogate(evidence({"rate": 6.0}, BOTH, RATE)), (Cause(RATE, 5),))
    assert (first.name, second.name) == ("scale_factor", "clock_drift")
    assert first.gain == pytest.approx(SESSIONS * 2.5 * np.log1p(9.0))
    assert first.gain > second.gain
    assert first.value == 6.0
    assert first.gain_beside is None
    assert second.gain_beside is not None
    assert second.gain_beside < 0.0
    assert first.takes_away == pytest.approx(1.0)
    assert second.takes_away is not None
    assert second.takes_away < 1.0


def test_where_nothing_deviates_nothing_is_taken_away() -> None:
    """There is no share of nothing."""
    assert [one.takes_away for one in ranking(Surrogate(evidence({}, RATE)), ())] == [None]


def test_what_would_explain_all_that_stands_out_is_listed_the_best_first() -> None:
    """And neither what leaves something, nor what no effect of the catalogue does."""
    better = response("latency", {"rate": 1.0, "lag": 0.4})
    strange = Response(candidate("?moving"), RATE.mean, RATE.spread)
    shown = evidence({"rate": 6.0, "lag": 2.4}, RATE, better, BOTH, strange)
    assert [one.name for one in would_explain(Surrogate(shown))] == ["latency", "scale_factor"]


def test_what_gains_twenty_to_one_is_worth_a_look() -> None:
    """A rate that is off by one sigma in each of four sessions hints at something; a tenth of it does not."""
    better = response("latency", {"rate": 1.0, "lag": 0.4})
    assert [one.name for one in hinted(Surrogate(evidence({"rate": 2.0}, RATE, better)))] == ["scale_factor", "latency"]
    assert hinted(Surrogate(evidence({"rate": 0.1}, RATE, better))) == ()


def test_lookalikes_have_their_cosine() -> None:
    """Of (1, 0) and (1, 1) it is the root of a half, too little to be told; of (1, 0) and (1, 0.5) it is 0.89."""
    near = response("temp_bias", {"rate": 1.0, "clock_ratio": 0.5})
    found = lookalikes(evidence({}, RATE, BOTH, near))
    assert [(one.first, one.second) for one in found] == [("clock_drift", "temp_bias"), ("scale_factor", "temp_bias")]
    assert [one.cosine for one in found] == pytest.approx([1.5 / np.sqrt(2.0 * 1.25), 1.0 / np.sqrt(1.25)])
