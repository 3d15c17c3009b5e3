"""Attitude of a simulated device with three axes: in the state of a service, in its outputs and in `top`."""

from pathlib import Path

import pytest
from outputs_support import address_of, connected
from support import PATIENCE_S, Command

from gyrodrift.service.control_client import ControlClient


def test_state_outputs_and_top_tell_of_a_table_that_leans(tmp_path: Path) -> None:
    link, control = tmp_path / "tty", tmp_path / "control"
    motion = ("--axes", "3", "--profile", "leaning-turntable", "--wait", "--quiet")
    options = ("--control", control, "--log-format", "json", "--output", "tcp:port=0", "--output", "gpsd:port=0")
    with Command("--link", link, *motion, module="firmware_sim") as device:
        device.until(lambda _: link.is_symlink(), "port")
        with (
            Command("serve", "--port", link, *options) as serve,
            connected(address_of(serve, "tcp")) as lines,
            connected(address_of(serve, "gpsd")) as boat,
            ControlClient(control, PATIENCE_S) as person,
        ):
            boat.connection.sendall(b'?WATCH={"enable":true,"json":true};\n')
            while "q" not in (sample := lines.until("SAMPLE")):
                pass
            while "pitch" not in (report := boat.until("ATT")):
                pass
            status = person.ask("status")
            with Command("top", control) as top:
                assert top.end() == 0
            assert serve.stop() == 0
    assert sample["tilt_deg"] == pytest.approx(15.0, abs=2.0)
    assert report["pitch"] == pytest.approx(-sample["pitch_deg"], abs=1.0)
    assert report["roll"] == pytest.approx(sample["roll_deg"], abs=1.0)
    assert status["config"]["mount"] == {"up": "+z", "forward": "+x"}
    for name in ("tilt_deg", "roll_deg", "pitch_deg"):
        assert status["filter"][name] == pytest.approx(sample[name], abs=1.0)
    assert "Roll" in top.out
    assert "Tilt" in top.out
