"""Features that baseline and recordings have in common, and remarks on the others."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from simulate_support import BASE, MOTION

from firmware_sim.effects.catalogue import CATALOGUE
from firmware_sim.rig import Rig, parse_effect
from gyrodrift.diagnose.baseline_comparison import compared_of, explained_baseline, without_baseline
from gyrodrift.diagnose.features.vector import NOT_OF_STEPS, NUMBER, SLOW
from gyrodrift.diagnose.inference.verdict import Verdict
from gyrodrift.diagnose.recording.recording import Recording, recording_of
from gyrodrift.diagnose.stages import DiagnosisRequest, inferred_of, recordings_of, simulated_of
from gyrodrift.simulation.sessions import Simulation, write_simulation


@cache
def observed(rate_hz: float = 100.0, lsb_dps: float = 0.00763, cpr: int = 4096) -> Recording:
    base = BASE.model_copy(update={"sample_rate_hz": rate_hz, "dps_per_lsb": lsb_dps, "encoder_cpr": cpr})
    return recording_of(Simulation(Rig(base=base), MOTION, seed=1, minutes=1.5).whole())


def test_the_same_device_is_compared_in_everything() -> None:
    """A PLL that is off by one percent is the same sample rate."""
    compared, statement = compared_of([observed(), observed()], [observed(101.0)])
    assert compared.all()
    assert statement == []


@pytest.mark.parametrize(
    ("peer", "words"),
    [(observed(200.0), ["100", "200", "samples a second"]), (observed(lsb_dps=0.0305), ["0.00763", "0.0305", "steps"])],
    ids=["rate", "step"],
)
def test_of_another_rate_or_step_what_is_slow_is_compared(peer: Recording, words: list[str]) -> None:
    compared, statement = compared_of([observed()], [peer])
    assert np.array_equal(compared, SLOW)
    (sentence,) = statement
    assert all(word in sentence for word in (*words, "not compared"))


def fine(item: Recording) -> Recording:
    rate_noise_dps, angle_noise_deg = np.random.default_rng(1).normal(0.0, 0.01, (2, len(item.rate_dps)))
    return replace(item, rate_dps=item.rate_dps + rate_noise_dps, encoder_deg=item.encoder_deg + angle_noise_deg)


@pytest.mark.parametrize("order", [1, -1])
def test_where_one_of_both_has_no_steps_all_else_is_compared(order: int) -> None:
    """A rate that was filtered or converted on its way is still that of the same device."""
    first, second = [[fine(observed())], [observed()]][::order]
    compared, (sentence,) = compared_of(first, second)
    assert np.array_equal(compared, NOT_OF_STEPS)
    assert "0.00763" in sentence


def test_steps_that_hide_the_noise_are_compared_with_a_baseline_without_steps() -> None:
    coarse = replace(observed(), rate_dps=np.rint(observed().rate_dps / 0.5) * 0.5)
    assert compared_of([fine(observed())], [coarse])[0].all()
    assert not compared_of([coarse], [fine(observed())])[0].all()


def test_coarser_steps_may_be_an_effect() -> None:
    assert compared_of([observed()], [observed(lsb_dps=0.0231)])[0].all()
    assert not compared_of([observed(lsb_dps=0.0231)], [observed()])[0].all()
    rests = replace(observed(), rate_dps=0.0 * observed().rate_dps)
    assert compared_of([observed()], [rests])[0].all()


@pytest.mark.evaluation
def test_beside_a_baseline_of_another_sample_rate_a_scale_error_is_found(tmp_path: Path) -> None:
    rigs = {
        "before": Rig(base=BASE),
        "today": Rig(
            base=BASE.model_copy(update={"sample_rate_hz": 200.0}),
            effects=(parse_effect("scale_factor:error_percent=3"),),
        ),
    }
    paths: dict[str, list[Path]] = {name: [tmp_path / f"{name}-{number}.csv" for number in (1, 2)] for name in rigs}
    for name, rig in rigs.items():
        for number, path in enumerate(paths[name]):
            write_simulation(path, Simulation(rig, MOTION, 5, number, minutes=1.0))
    withheld = frozenset(CATALOGUE) - {"scale_factor", "latency", "timestamp_jitter"}
    request = DiagnosisRequest(paths["today"], Rig(base=BASE), withheld, 1, lambda *_: None, baseline=paths["before"])
    recordings, _ = recordings_of(request.paths)
    explained = explained_baseline(request, recordings)
    assert any("100 samples a second" in remark and "200" in remark for remark in explained.remarks)
    compared = explained.baseline.compared
    assert SLOW[compared].all()
    assert compared[NUMBER["rate"]]
    simulated = simulated_of(request, recordings)
    tables = without_baseline(simulated.tables, simulated.subjects, explained.baseline)
    verdict = inferred_of(simulated._replace(tables=tables), 1).verdict
    assert [cause.effect.name for cause in verdict.causes] == ["scale_factor"]
    assert verdict.causes[0].parameters[0].value == pytest.approx(3.0, rel=0.1)


def told_beside(tmp_path: Path, name: str, before: Sequence[str], today: Sequence[str]) -> Verdict:
    paths: dict[str, list[Path]] = {}
    for stem, texts in (("before", before), ("today", today)):
        paths[stem] = [tmp_path / f"{stem}-{number}.csv" for number in range(len(texts))]
        for number, (path, text) in enumerate(zip(paths[stem], texts, strict=True)):
            effects = (parse_effect(f"{name}:{text}"),) if text else ()
            write_simulation(
                path, Simulation(Rig(base=BASE, effects=effects), MOTION, 8, len(stem) + number, minutes=1.0)
            )
    withheld = frozenset(CATALOGUE) - {name}
    request = DiagnosisRequest(paths["today"], Rig(base=BASE), withheld, 1, lambda *_: None, baseline=paths["before"])
    recordings, _ = recordings_of(request.paths)
    explained = explained_baseline(request, recordings)
    simulated = simulated_of(request._replace(rig=explained.rig), recordings)
    tables = without_baseline(simulated.tables, simulated.subjects, explained.baseline)
    return inferred_of(simulated._replace(tables=tables), 1, background=explained.background).verdict


@pytest.mark.long
@pytest.mark.parametrize(
    ("before", "today", "named"),
    [
        pytest.param((-1.0, 0.0, 1.0), (0.4, 1.6, 1.0), [], marks=pytest.mark.evaluation),
        ((-0.1, 0.1), (1.1, 0.9), ["scale_factor"]),
    ],
    ids=["varies", "changed"],
)
def test_a_gain_is_new_where_it_varies_less_than_it_changed(
    tmp_path: Path, before: tuple[float, ...], today: tuple[float, ...], named: list[str]
) -> None:
    texts = [[f"error_percent={percent}" if percent else "" for percent in percents] for percents in (before, today)]
    verdict = told_beside(tmp_path, "scale_factor", *texts)
    assert [cause.effect.name for cause in verdict.causes] == named
    assert verdict.kind == ("effect" if named else "none")


@pytest.mark.evaluation
def test_what_has_a_phase_of_its_own_in_each_recording_is_new_beside_recordings_without(tmp_path: Path) -> None:
    phases_deg = np.random.default_rng(2).uniform(0.0, 360.0, 6)[3:]
    today = [
        f"amplitude_dps={amplitude},phase_deg={phase:.1f}"
        for amplitude, phase in zip((0.08, 0.09, 0.07), phases_deg, strict=True)
    ]
    verdict = told_beside(tmp_path, "g_sensitivity", ("", "", ""), today)
    assert [cause.effect.name for cause in verdict.causes] == ["g_sensitivity"]
