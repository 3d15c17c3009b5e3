"""Attitude in JSON lines: of stdout, of clients, for PlotJuggler and on MQTT."""

import json
from math import nan

import pytest
import structlog
from outputs_support import connected, corrected, hub, tilted

from gyrodrift.outputs.fields import CHOICES, OF_THREE_AXES
from gyrodrift.outputs.json_line import chosen_line, json_line
from gyrodrift.outputs.mqtt import state
from gyrodrift.outputs.options import LOOPBACK
from gyrodrift.outputs.output import OutputHost
from gyrodrift.outputs.udp import UdpOptions, UdpOutput

NEW = {field.name for field in OF_THREE_AXES}


def test_a_line_has_the_attitude_behind_the_values_of_one_axis() -> None:
    level, tilt = corrected(3, yaw_deg=30.0), tilted(3)
    assert json_line(tilt) == json_line(level)[:-2] + (
        ',"q":[0.947744,0.125430,-0.146830,0.253947],"tilt_deg":22.2687,"roll_deg":10.0000,"pitch_deg":-20.0000,'
        '"tilt_sigma_deg":0.4000,"bias_xyz_dps":[0.10000,0.20000,0.25000]}\n'
    )


@pytest.mark.promise("Clients of outputs")
def test_one_axis_has_no_attitude() -> None:
    """Lines of a device with one axis have no attitude."""
    assert not NEW & set(json.loads(json_line(corrected(0))))
    assert not NEW & set(json.loads(chosen_line(corrected(0), CHOICES)))
    assert not NEW & set(json.loads(state(corrected(0))))


@pytest.mark.parametrize(
    ("unknown", "missing"),
    [
        ({"tilt_sigma_deg": nan}, {"tilt_sigma_deg"}),
        ({"bias_x_dps": nan, "roll_deg": nan}, {"bias_xyz_dps", "roll_deg"}),
    ],
)
def test_unknown_values_are_left_out(unknown: dict[str, float], missing: set[str]) -> None:
    sample = tilted(0)
    assert sample.attitude is not None
    sample = sample._replace(attitude=sample.attitude._replace(**unknown))
    assert NEW & set(json.loads(json_line(sample))) == NEW - missing
    assert {name for name in NEW if json.loads(state(sample))[name] is None} == missing


def test_fields_are_chosen_by_name() -> None:
    with hub("tcp:port=0") as outputs, connected(outputs.endpoint()) as client:
        assert {"q", "roll_deg"} <= set(client.until("HELLO")["fields"])
        client.connection.sendall(b'{"class":"WATCH","fields":["seq","q","pitch_deg"]}\n')
        client.until("WATCH")
        outputs.samples([tilted(5)])
        line = client.json()
    assert line == {"class": "SAMPLE", "seq": 5, "q": [0.947744, 0.12543, -0.14683, 0.253947], "pitch_deg": -20.0}


def test_plotjuggler_gets_lists() -> None:
    output = UdpOutput(UdpOptions(LOOPBACK), OutputHost(structlog.get_logger()))
    datagram = json.loads(output.datagram(tilted(0)))
    assert datagram["q"] == list(tilted(0).attitude or ())[:4]
    assert datagram["roll_deg"] == 10.0
    assert not NEW & set(json.loads(output.datagram(corrected(0))))
