"""Outputs of one of several gyros: its name is in topics, tables and labels."""

import pytest
import structlog
from outputs_support import corrected

from gyrodrift.outputs.line_output import sample_opening
from gyrodrift.outputs.mqtt import MqttOptions, MqttOutput
from gyrodrift.outputs.output import OutputHost
from gyrodrift.outputs.signalk import delta


def host(source: str = "") -> OutputHost:
    return OutputHost(structlog.get_logger(), source=source)


def test_two_gyros_do_not_share_a_topic_of_mqtt() -> None:
    topics = {MqttOutput(MqttOptions(), host(source))._topics.state for source in ("", "left", "right")}
    assert len(topics) == 3
    assert MqttOutput(MqttOptions(id="robot"), host("left"))._topics.state.endswith("robot/state")


def test_networktables_has_a_table_for_each_gyro() -> None:
    pytest.importorskip("ntcore", reason="the output needs the extra networktables")
    from gyrodrift.outputs.networktables import NetworkTablesOptions, NetworkTablesOutput  # noqa: PLC0415

    assert NetworkTablesOutput(NetworkTablesOptions(), host())._prefix == "/gyrodrift/"
    assert NetworkTablesOutput(NetworkTablesOptions(), host("left"))._prefix == "/gyrodrift/left/"


def test_a_delta_of_signal_k_names_the_gyro() -> None:
    labels = [delta(corrected(1), source)["updates"][0]["source"]["label"] for source in ("", "left")]
    assert labels == ["gyrodrift", "gyrodrift.left"]


def test_a_line_of_one_gyro_is_unchanged() -> None:
    assert sample_opening("") == '{"class":"SAMPLE",'
    assert sample_opening("left") == '{"class":"SAMPLE","source":"left",'
