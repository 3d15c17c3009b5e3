"""A calibration of the running service, step by step through its control socket."""

import json
import time
from pathlib import Path
from typing import Any

from calibrate_support import GAIN_CCW, GAIN_CW, Table, to_and_fro, turn_s
from support import PATIENCE_S, Command, near, speaking_on

from gyrodrift.config.model import load_config
from gyrodrift.service.control_client import ControlClient

TURNS_DEG = [360.0, -360.0] * 3


def asked_until(client: ControlClient, serve: Command, step: str) -> dict[str, Any]:
    """The state of the calibration, once it is at a step."""
    until_s = time.monotonic() + PATIENCE_S
    while (state := client.ask("calibrate state"))["step"] != step:
        serve.glance()
        assert time.monotonic() < until_s, state
    return state


def test_it_measures_the_scale_writes_the_config_and_applies_it(tmp_path: Path) -> None:
    """Rest, three turns each way, a mark at each stop; comments of the config stay."""
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
    found = load_config(config).calibration
    assert found is not None
    assert found.scale_ccw == near(1.0 / GAIN_CCW, 0.002)
    assert found.scale_cw == near(1.0 / GAIN_CW, 0.002)
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
