"""The table of fields: a further record is all that a further value of a sample needs."""

import os
import subprocess
import sys

EXTRA = """
from gyrodrift.outputs import fields

more = fields.Field("reference_deg", "reference_deg", "Angle of the encoder, unwrapped.", "Reference", 2)
fields.OF_EVERY_DEVICE += (more,)
fields.FIELDS += (more,)
fields.CHOICES[more.name] = more

import json
from dataclasses import asdict

import structlog
from outputs_support import corrected

from gyrodrift.outputs import gpsd, home_assistant, mqtt, networktables, prometheus, status, udp
from gyrodrift.outputs.foxglove import SAMPLE, STATE
from gyrodrift.outputs.json_line import json_line
from gyrodrift.outputs.line_output import hello
from gyrodrift.outputs.output import OutputHost
from gyrodrift.outputs.web.points import LAYOUTS
from gyrodrift.top.view import figures

sample, host = corrected(3), OutputHost(structlog.get_logger())
assert json.loads(json_line(sample))["reference_deg"] == 10.0
assert "reference_deg" not in json.loads(json_line(sample._replace(reference_deg=float("nan"))))
assert "reference_deg" in json.loads(hello())["fields"]
assert json.loads(udp.UdpOutput(udp.UdpOptions(), host).datagram(sample))["reference_deg"] == 10.0
assert json.loads(mqtt.state(sample))["reference_deg"] == 10.0
assert gpsd.reports(sample, "")[1]["reference_deg"] == 10.0
now = status.ServiceStatus(filter=status.FilterStatus(reference_deg=10.0))
assert status.ServiceStatus.from_dict(asdict(now)) == now
assert ("reference_degrees", more.description, 10.0) in prometheus.gauges(now)
topics = home_assistant.Topics.of("gyrodrift", "gyro")
entity = json.loads(home_assistant.discovery("gyro", topics, now.device, "1"))["cmps"]["reference_deg"]
assert (entity["name"], entity["unit_of_meas"], entity["suggested_display_precision"]) == ("Reference", "°", 2)
assert all("reference_deg" in channel.schema["properties"] for channel in (SAMPLE, STATE))
assert networktables.TOPICS["reference_deg"] == "double"
assert all("reference_deg" in layout.columns for layout in LAYOUTS.values())
assert ("Reference", "10.00 deg") in [(figure.label, figure.says) for figure in figures(now)]
"""


def test_a_further_record_is_in_all_outputs() -> None:
    env = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
    done = subprocess.run([sys.executable, "-c", EXTRA], capture_output=True, text=True, check=False, env=env)
    assert done.stderr == ""
