"""A calibration of the running service, step by step through its control socket."""

import json
import os
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest
import structlog
from calibrate_support import GAIN_CCW, GAIN_CW, Table, to_and_fro, turn_s
from laid_board import SCALE, SIX_SIDES, WITH_TURNS, laid_board
from support import PATIENCE_S, Command, near, speaking_on

from gyrodrift.calibrate.guide import Guide
from gyrodrift.config.model import load_config
from gyrodrift.link.protocols.decoder import DeviceDescription
from gyrodrift.service import guided
from gyrodrift.service.calibrating import Calibrating
from gyrodrift.service.control_client import ControlClient
from gyrodrift.service.guided import GuidedCalibration
from gyrodrift.values.calibration import Calibration
from gyrodrift.values.errors import CalibrationError
from gyrodrift.values.sample import Sample

TURNS_DEG = [360.0, -360.0] * 3


def asked_until(client: ControlClient, serve: Command, step: str) -> dict[str, Any]:
    """The state of the calibration, once it is at a step."""
    until_s = time.monotonic() + PATIENCE_S
    while (state := client.ask("calibrate state"))["step"] != step:
        serve.glance()
        assert time.monotonic() < until_s, state
    return state


@pytest.mark.promise("Clients of outputs")
def test_it_measures_the_scale_writes_the_config_and_applies_it(tmp_path: Path) -> None:
    """A calibration of the running service is written to its config and applied."""
    config, control = tmp_path / "my.yaml", tmp_path / "control"
    config.write_text("# mine\nfilter: restlevel\n")
    words = ("--port", tmp_path / "gyro", "--config", config, "--control", control)
    with speaking_on(tmp_path / "gyro") as device, Command("serve", *words) as serve:
        table = Table(device, tmp_path, to_and_fro(TURNS_DEG)).play(1.0)
        serve.take_lines(50)
        with ControlClient(control, PATIENCE_S) as client:
            assert client.ask("calibrate mark")["error"] == "no calibration runs; begin with calibrate start"
            assert client.ask("calibrate start")["step"] == "ready"
            assert client.ask("calibrate mark")["step"] == "rest"
            table.play(13.0)
            asked_until(client, serve, "turning")
            for angle_deg in TURNS_DEG:
                table.play(turn_s(angle_deg) + 4.0)
                serve.until(lambda it: len(it.out.split("\n")) > table.t_s * 100 - 20, "all samples")
                state = client.ask("calibrate mark")
        assert state["step"] in ("turning", "idle"), state
        serve.until_log("event=calibration_applied")
        serve.until_log("event=config_applied")
        assert "calibrate mark" in serve.log
        assert "calibrate state" not in serve.log
    result = load_config(config).calibration
    assert result is not None
    assert result.scale_ccw == near(1.0 / GAIN_CCW, 0.002)
    assert result.scale_cw == near(1.0 / GAIN_CW, 0.002)
    assert config.read_text().startswith("# mine\nfilter: restlevel\n")


def test_without_a_config_nothing_is_written_and_a_cancelled_one_ends(tmp_path: Path) -> None:
    """The guide can be left at any step; finishing without turns says what is missing."""
    control = tmp_path / "control"
    with (
        speaking_on(tmp_path / "gyro") as device,
        Command("serve", "--port", tmp_path / "gyro", "--control", control) as serve,
    ):
        Table(device, tmp_path, to_and_fro(TURNS_DEG)).play(1.0)
        serve.take_lines(50)
        for words, sentence in (("cancel", "Canceled; nothing is written."), ("finish", "Nothing is written: ")):
            with Command("ctl", control, "calibrate", "start") as start:
                assert start.end() == 0
            with Command("ctl", control, "calibrate", words) as end:
                assert end.end() == 0
            answer = json.loads(end.out)
            assert answer["step"] == "idle"
            assert answer["says"][-1].startswith(sentence)
        assert serve.stop() == 0


def begun(config: Path | None = None, kind: str = "start") -> GuidedCalibration:
    """A calibration that has begun, beside a link that speaks."""
    device = DeviceDescription()
    link = SimpleNamespace(decoder=None, device=device, name="gyro", silent_s=lambda: 0.0)
    watch = None if config is None else SimpleNamespace(path=config)
    log = structlog.get_logger()
    pipeline: Any = SimpleNamespace(link=link, log=log, state=SimpleNamespace(bias_dps=0.0))
    pipeline.calibrating = Calibrating(pipeline.link, log, lambda *_: None)
    calibration = GuidedCalibration(pipeline, cast("Any", watch))
    waited_for(calibration.start(kind))
    return calibration


def waited_for(answer: Callable[[], Mapping[str, Any] | None]) -> None:
    """Ask for an answer that comes later until it is there."""
    while answer() is None:
        time.sleep(0.01)


@pytest.mark.promise("Clients of outputs")
def test_a_mistake_in_a_calibration_does_not_end_the_service(monkeypatch: pytest.MonkeyPatch) -> None:
    """A calibration that fails unexpectedly ends without the service."""

    def fail(*_: Any) -> None:
        raise ValueError("zero-size array")

    calibration = begun()
    monkeypatch.setattr(Guide, "take", fail)
    calibration.take([Sample(0, 0.0, 0.0, 0.0)])
    assert calibration.state()["step"] == "idle"
    assert calibration.state()["says"][-1] == "Nothing is written: ValueError: zero-size array"


@pytest.mark.promise("Clients of outputs")
def test_another_device_ends_a_calibration() -> None:
    """A calibration ends if another device is connected meanwhile."""
    calibration = begun()
    link: Any = calibration.pipeline.link
    for device_id in (None, "first", None, "first"):
        link.device = DeviceDescription(device_id=device_id)
        calibration.take([Sample(0, 0.0, 0.0, 0.0)])
        assert calibration.state()["step"] == "ready"
    link.device = DeviceDescription(device_id="second")
    calibration.take([Sample(1, 0.01, 0.01, 0.0)])
    assert calibration.state()["step"] == "idle"
    assert calibration.state()["says"][-1] == "Another device is connected; nothing is written."


@pytest.mark.promise("Clients of outputs")
def test_a_second_calibration_is_refused_while_one_runs() -> None:
    """A calibration is not restarted by another client."""
    calibration = begun()
    calibration.press("mark")
    again = calibration.start()
    with pytest.raises(CalibrationError, match="a calibration runs already; finish or cancel it first"):
        waited_for(again)
    assert calibration.state()["step"] == "rest"


@pytest.mark.promise("Clients of outputs")
def test_a_calibration_that_its_user_left_ends() -> None:
    """A calibration without a key for 5 minutes ends; its memory is bounded."""
    calibration = begun()
    calibration.tick(0.0)
    calibration.tick(guided.UNATTENDED_S)
    calibration.press("mark")
    calibration.tick(2.0 * guided.UNATTENDED_S)
    assert calibration.state()["step"] == "rest"
    calibration.tick(3.0 * guided.UNATTENDED_S + 1.0)
    assert calibration.state()["step"] == "idle"
    assert calibration.state()["says"][-1] == "No key for 5 min; nothing is written."


NO_FOLDER = b""
"""Content of a config whose folder is gone."""


@pytest.mark.promise("Clients of outputs")
@pytest.mark.parametrize(
    "content", [b"filter: [", b"filter: \xff", None, NO_FOLDER], ids=["no YAML", "no text", "a pipe", "no folder"]
)
def test_a_config_that_cannot_be_written_costs_no_calibration(
    content: bytes | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A calibration whose config cannot be read or written is applied, and the config stays as it is."""
    config = tmp_path / ("my.yaml" if content != NO_FOLDER else "gone/my.yaml")
    if content == NO_FOLDER:
        pass
    elif content is None:
        os.mkfifo(config)
    else:
        config.write_bytes(content)
    calibration = begun(config)
    result = Calibration("2026-05-01T12:00:00+00:00")
    monkeypatch.setattr(Guide, "result", lambda *_: result)
    calibration.press("finish")
    state = calibration.state()
    assert state["step"] == "idle"
    assert state["says"][-1].startswith("Applied until the service ends; it is not written: ")
    assert str(config) in state["says"][-1]
    assert calibration.pipeline.calibrating.given == result
    assert not content or config.read_bytes() == content


def test_a_calibration_of_the_service_keeps_the_accelerometer_of_its_device(monkeypatch: pytest.MonkeyPatch) -> None:
    """The guide of the service measures one axis; six positions measured before stay valid."""
    calibration = begun()
    calibration.pipeline.calibrating.given = Calibration("2026-01-01", accel_scale=(1.01, 0.99, 1.0))
    monkeypatch.setattr(Guide, "result", lambda *_: Calibration("2026-05-01", scale_ccw=0.98))
    calibration.press("finish")
    applied = calibration.pipeline.calibrating.given
    assert applied == Calibration("2026-05-01", scale_ccw=0.98, accel_scale=(1.01, 0.99, 1.0))


@pytest.mark.parametrize(("kind", "legs"), [("positions", SIX_SIDES), ("axis-turns", WITH_TURNS)])
def test_six_sides_are_measured_while_the_service_runs(
    kind: str, legs: tuple[str | float, ...], tmp_path: Path
) -> None:
    config = tmp_path / "my.yaml"
    config.write_text("filter: restlevel\n")
    calibration = begun(config, kind)
    calibration.pipeline.calibrating.given = Calibration("2026-01-01", bias_dps_per_c=0.01)
    samples = laid_board(legs).through_sensor().samples()
    for now_s, start in enumerate(range(0, len(samples), 50)):
        calibration.take(samples[start : start + 50])
        calibration.tick(10.0 * now_s)
    assert calibration.state()["step"] == "idle"
    assert calibration.state()["says"][-1] == f"Written to {config}; it is applied at once."
    written = load_config(config).calibration
    assert written is not None
    assert written.accel_scale == pytest.approx(SCALE, abs=0.002)
    assert (written.gyro_matrix is not None) == (kind == "axis-turns")
    assert written.bias_dps_per_c == 0.01


def test_a_service_on_one_axis_has_no_six_sides() -> None:
    calibration = begun(kind="positions")
    calibration.take([Sample(i, i / 100, i / 100, 0.0) for i in range(100)])
    says = calibration.state()["says"]
    assert says[-1].startswith("Nothing is written: the device does not send three rates and three accelerations")
