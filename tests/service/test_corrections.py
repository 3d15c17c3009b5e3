"""Restarts and corrections on the way of samples through `serve`."""

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
import structlog

from gyrodrift.config.model import Config
from gyrodrift.link.clocks.arrival import ArrivalClock
from gyrodrift.link.clocks.device import DeviceClock
from gyrodrift.link.options import LinkCounters
from gyrodrift.link.protocols.decoder import DeviceDescription
from gyrodrift.service.pipeline import Pipeline
from gyrodrift.service.reference import SmoothYaw
from gyrodrift.values.sample import Corrected, Sample

RATE_HZ = 100.0


class Collected:
    """A sink that keeps the corrected samples."""

    is_wanted = True

    def __init__(self) -> None:
        self.samples: list[Corrected] = []

    def take(self, samples: list[Corrected]) -> None:
        self.samples += samples

    def tick(self, _now_s: float) -> None: ...


class Played:
    """A pipeline whose device is at rest."""

    def __init__(self, clock: Any = None, config: Config | None = None) -> None:
        self.sink, self.rng, self.count = Collected(), np.random.default_rng(1), 0
        link = SimpleNamespace(device=DeviceDescription(), name="", clock=clock, counters=LinkCounters())
        self.pipeline = Pipeline(cast("Any", link), [cast("Any", self.sink)], structlog.get_logger(), config)

    def play(self, bias_dps: float, seconds: float) -> None:
        for _ in range(round(seconds * RATE_HZ)):
            self.count += 1
            t_s = self.count / RATE_HZ
            self.pipeline.take([Sample(self.count, t_s, t_s, bias_dps + self.rng.normal(0.0, 0.05))])
            self.pipeline.tick(t_s)


@pytest.mark.parametrize(
    ("event", "fields", "clock"),
    [
        ("device_reset", {"gone_s": 0.5}, None),
        ("link_restored", {"gone_s": 5.0}, ArrivalClock(0.0)),
        ("device", {"device_id": "other"}, None),
    ],
)
def test_a_restart_reopens_the_bias_and_is_told(event: str, fields: dict[str, Any], clock: Any) -> None:
    played = Played(clock)
    played.pipeline.hear("device", {"device_id": "one"})
    played.play(0.2, 20.0)
    played.pipeline.hear(event, fields)
    with structlog.testing.capture_logs() as events:
        played.play(1.2, 60.0)
    assert [event["count"] for event in events if event["event"] == "bias_reopened"] == [1]
    assert abs(played.pipeline.yaw_deg) < 0.5
    assert played.sink.samples[-1].yaw_sigma_deg > 5.0


@pytest.mark.parametrize(
    ("event", "fields", "clock"),
    [
        ("link_restored", {"gone_s": 5.0}, DeviceClock(0.0)),
        ("link_restored", {"gone_s": 0.2}, ArrivalClock(0.0)),
        ("device", {"device_id": "one"}, None),
        ("gap", {"missing": 3, "seconds": 0.04}, None),
    ],
)
def test_what_is_no_restart_keeps_the_bias(event: str, fields: dict[str, Any], clock: Any) -> None:
    """A device clock that goes on over an outage shows that the device was not switched off."""
    played = Played(clock)
    played.pipeline.hear("device", {"device_id": "one"})
    played.play(0.2, 20.0)
    played.pipeline.hear(event, fields)
    played.play(0.2, 1.0)
    assert played.pipeline.run.restarts == 0
    assert played.sink.samples[-1].yaw_sigma_deg < 1.0


def test_a_correction_is_in_its_sample_and_told_and_taken_in_slowly() -> None:
    played = Played(config=Config(slew_dps=0.5))
    played.play(0.2, 20.0)
    played.pipeline.hear("device_reset", {"gone_s": 0.5})
    with structlog.testing.capture_logs() as events:
        played.play(1.2, 20.0)
    samples = played.sink.samples
    steps_deg = np.array([sample.correction_deg for sample in samples])
    largest = int(np.abs(steps_deg).argmax())
    assert abs(steps_deg[largest]) > 1.0
    assert [event["step_deg"] for event in events if event["event"] == "yaw_corrected"] == [
        round(steps_deg[largest], 3)
    ]
    assert (samples[largest - 1].corrections, samples[-1].corrections) == (0, 1)
    smooth_deg = np.array([sample.smooth_yaw_deg for sample in samples])
    assert np.abs(np.diff(smooth_deg)).max() < 0.03
    assert smooth_deg[-1] == samples[-1].yaw_deg
    played.pipeline.zero()
    assert played.pipeline.now().smooth_yaw_deg == 0.0


def test_without_a_slew_there_is_no_smooth_yaw() -> None:
    played = Played()
    played.play(0.2, 1.0)
    assert np.isnan(played.sink.samples[-1].smooth_yaw_deg)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_smooth_yaw_takes_a_step_in_at_its_speed(sign: float) -> None:
    smooth = SmoothYaw()
    smooth.follow(10.0 * sign, 0.0, 2.0)
    assert smooth.behind_deg == 10.0 * sign
    for expected_deg in (8.0, 6.0, 4.0, 2.0, 0.0, 0.0):
        smooth.follow(0.0, 1.0, 2.0)
        assert smooth.behind_deg == expected_deg * sign
