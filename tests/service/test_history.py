"""A config that changes on the way: the samples before it are filtered again."""

from itertools import pairwise
from types import SimpleNamespace
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest

from gyrodrift.filters.hdr_filter import HDR
from gyrodrift.filters.restlevel_filter import RESTLEVEL
from gyrodrift.service import history
from gyrodrift.service.history import History
from gyrodrift.service.pipeline import Pipeline
from gyrodrift.values.mount import LEVEL
from gyrodrift.values.sample import Corrected, Inertial, Sample

DEFAULTS, TUNED = RESTLEVEL.params(), RESTLEVEL.params(walk_dps_rts=0.03, drift_dps_s=0.03)
HZ, RELOAD_S, SECONDS = 20, 25, 50


class Kept:
    """A sink that keeps all samples."""

    is_wanted = True

    def __init__(self) -> None:
        self.corrected: list[Corrected] = []

    def take(self, corrected: list[Corrected]) -> None:
        """Keep them."""
        self.corrected += corrected


def config(chosen: Any, params: Any) -> Any:
    """A config with these parameters."""
    return SimpleNamespace(chosen=chosen, params=params, calibration=None, slew_dps=None, axes="auto", mount=LEVEL)


def drive(*, has_axes: bool = False) -> list[Sample]:
    """A drive with rests, with a bias that wanders."""
    generator = np.random.default_rng(3)
    t_s = np.arange(SECONDS * HZ) / HZ
    true_dps = np.where((t_s > 8.0) & (t_s % 12.0 > 4.0), 30.0 * np.sin(t_s), 0.0)
    bias_dps = 0.3 + np.cumsum(generator.normal(0.0, 0.03 / HZ**0.5, t_s.size))
    rates = (true_dps + bias_dps + generator.normal(0.0, 0.05, t_s.size)).tolist()
    axes = [Inertial(0.0, 0.0, rate, 0.0, 0.0, 9.81) if has_axes else None for rate in rates]
    triples = zip(t_s.tolist(), rates, axes, strict=True)
    return [Sample(index, at_s, at_s, rate, inertial=axes) for index, (at_s, rate, axes) in enumerate(triples)]


def pipeline_of(first: Any) -> tuple[Pipeline, Kept]:
    """A pipeline with a history that begins with a config."""
    sink = Kept()
    pipeline = Pipeline(Mock(), [sink], Mock(), first)  # type: ignore[list-item]  # the rest of a sink is not called
    pipeline.history = History()
    return pipeline, sink


def yaws(first: Any, second: Any, samples: list[Sample]) -> tuple[list[Corrected], Pipeline]:
    """The corrected samples of a drive with another config from the middle on."""
    pipeline, sink = pipeline_of(first)
    for begin in range(0, len(samples), 5):
        if second is not None and begin == RELOAD_S * HZ:
            pipeline.use(second)
        pipeline.take(samples[begin : begin + 5])
    return sink.corrected, pipeline


@pytest.fixture(autouse=True)
def _short_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(history, "PART_SAMPLES", 2000)


@pytest.mark.parametrize("has_axes", [False, True], ids=["one axis", "three axes"])
@pytest.mark.parametrize("before", [config(RESTLEVEL, DEFAULTS), config(HDR, HDR.params())], ids=["restlevel", "hdr"])
def test_after_a_reload_the_filter_is_as_if_it_had_begun_with_the_new_config(before: Any, *, has_axes: bool) -> None:
    """Soon after a reload the state is that of a run with the new config from the first sample on, bit by bit."""
    samples, tuned = drive(has_axes=has_axes), config(RESTLEVEL, TUNED)
    expected, _ = yaws(tuned, None, samples)
    got, pipeline = yaws(before, tuned, samples)
    late = slice((RELOAD_S + 1) * HZ, None)
    for column in ("bias_dps", "yaw_sigma_deg", "confidence"):
        assert [getattr(c, column) for c in got[late]] == [getattr(c, column) for c in expected[late]]
    step_deg = 0.0 if before.chosen is RESTLEVEL else got[-1].yaw_deg - expected[-1].yaw_deg
    assert [c.yaw_deg for c in got[late]] == pytest.approx([c.yaw_deg + step_deg for c in expected[late]], abs=1e-9)
    told = [call.args[0] for call in pipeline.log.info.call_args_list]  # type: ignore[attr-defined]
    assert told[-1] == "history_filtered"


def test_the_step_at_a_reload_is_a_correction() -> None:
    """Yaw minus all corrections has no step."""
    got, _ = yaws(config(RESTLEVEL, DEFAULTS), config(RESTLEVEL, TUNED), drive())
    around = got[RELOAD_S * HZ - 1 : RELOAD_S * HZ + 10]
    steps = [b.yaw_deg - a.yaw_deg - b.correction_deg for a, b in pairwise(around)]
    assert max(map(abs, steps)) < 30.0 / HZ + 0.1
    assert max(abs(c.correction_deg) for c in around) > 0.25


def test_a_zero_before_a_reload_stays_the_zero() -> None:
    """Samples before a zero are not filtered again."""
    pipeline, sink = pipeline_of(config(RESTLEVEL, DEFAULTS))
    samples = drive()
    pipeline.take(samples[: 8 * HZ])
    pipeline.zero()
    pipeline.use(config(RESTLEVEL, TUNED))
    pipeline.take(samples[8 * HZ :])
    assert abs(sink.corrected[8 * HZ].yaw_deg) < 0.1


def test_memory_is_bounded_and_a_late_reload_uses_what_is_there(monkeypatch: pytest.MonkeyPatch) -> None:
    """At most two parts are kept; a reload begins at the older one."""
    monkeypatch.setattr(history, "PART_SAMPLES", 300)  # the reload is in the second of them
    samples, tuned = drive(), config(RESTLEVEL, TUNED)
    got, pipeline = yaws(config(RESTLEVEL, DEFAULTS), tuned, samples)
    oldest = pipeline.history.oldest if pipeline.history else None
    assert oldest is not None
    assert oldest.following is not None
    assert (len(oldest), oldest.following.following) == (300, None)
    at_once, _ = yaws(tuned, None, samples)
    never, _ = yaws(config(RESTLEVEL, DEFAULTS), None, samples)
    off = [abs(run[-1].yaw_deg - at_once[-1].yaw_deg) for run in (got, never)]
    assert off[0] < off[1]


def test_a_filter_of_the_present_alone_keeps_yaw_and_bias() -> None:
    """With the same filter HDR, whose state is all it knows, yaw and bias go on."""
    got, pipeline = yaws(config(HDR, HDR.params()), config(HDR, HDR.params(tau_s=2.0)), drive())
    before, after = got[RELOAD_S * HZ - 1 : RELOAD_S * HZ + 1]
    assert abs(after.bias_dps - before.bias_dps) < 0.01
    assert "history_filtered" not in [call.args[0] for call in pipeline.log.info.call_args_list]  # type: ignore[attr-defined]
