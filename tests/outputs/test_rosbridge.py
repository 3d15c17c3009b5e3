"""rosbridge, with the clients that robots' programs and pages use."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import pairwise
from math import atan2, degrees, nan, radians
from pathlib import Path
from typing import Any

import pytest
from clients_support import fed, node_client, python_client
from outputs_support import AXES, WITHOUT_BIAS, HubThread, address_of, corrected, hub, serving, tilted
from websockets.sync.client import ClientConnection, connect

Rosbridge = tuple[HubThread, ClientConnection]


@contextmanager
def bridged(options: str = "") -> Iterator[Rosbridge]:
    with (
        hub(f"rosbridge:port=0{options}") as outputs,
        connect(f"ws://{outputs.address}", compression=None, close_timeout=0.1) as client,
    ):
        yield outputs, client


@pytest.fixture(scope="module")
def bridge() -> Iterator[Rosbridge]:
    with bridged() as result:
        yield result


def request(client: ClientConnection, op: str, **fields: Any) -> None:
    client.send(json.dumps({"op": op, **fields}))


def heard(client: ClientConnection) -> dict[str, Any]:
    return dict(json.loads(client.recv(20)))


def service(client: ClientConnection, name: str, **args: Any) -> dict[str, Any]:
    request(client, "call_service", service=name, args=args, id="s1")
    return heard(client)


def settled(client: ClientConnection) -> None:
    """Once all that was asked before is in force."""
    assert service(client, "/rosapi/nodes")["op"] == "service_response"


def imu_of(client: ClientConnection) -> dict[str, Any]:
    result = heard(client)
    assert result["op"] == "publish", result
    return dict(result["msg"])


@contextmanager
def subscribed(client: ClientConnection, topic: str = "/imu/data", **options: Any) -> Iterator[None]:
    request(client, "subscribe", topic=topic, **options)
    settled(client)
    yield
    request(client, "unsubscribe", topic=topic)
    settled(client)


def test_imu_is_what_the_message_defines(bridge: Rosbridge) -> None:
    """Yaw as a quaternion about z, rad/s, variances in rad², and -1 for acceleration, which nobody measures."""
    outputs, client = bridge
    with subscribed(client):
        outputs.samples([corrected(seq=100, yaw_deg=90.0, yaw_sigma_deg=0.5, corrected_dps=-180.0)])
        imu = imu_of(client)
    assert imu["header"] == {"stamp": {"sec": 1_700_000_001, "nanosec": 0}, "frame_id": "imu_link"}
    turn = imu["orientation"]
    assert (turn["x"], turn["y"]) == (0.0, 0.0)
    assert degrees(2.0 * atan2(turn["z"], turn["w"])) == pytest.approx(90.0)
    assert imu["orientation_covariance"][8] == pytest.approx(radians(0.5) ** 2)
    assert imu["orientation_covariance"][0] == imu["orientation_covariance"][4] == 1e6
    assert imu["angular_velocity"] == {"x": 0.0, "y": 0.0, "z": pytest.approx(-3.14159265)}
    assert imu["angular_velocity_covariance"] == [0.0] * 9
    assert imu["linear_acceleration_covariance"][0] == -1.0


def test_a_sigma_that_is_not_known_is_minus_one(bridge: Rosbridge) -> None:
    outputs, client = bridge
    with subscribed(client):
        outputs.samples([corrected(seq=200, yaw_sigma_deg=nan)])
        covariance = imu_of(client)["orientation_covariance"]
    assert (covariance[0], covariance[8]) == (-1.0, -1.0)


def test_a_device_with_three_axes_sends_all_of_them(bridge: Rosbridge) -> None:
    outputs, client = bridge
    sample = tilted(seq=210)
    assert sample.attitude is not None
    with subscribed(client):
        outputs.samples([sample])
        imu = imu_of(client)
    turn = imu["orientation"]
    assert (turn["w"], turn["x"], turn["y"], turn["z"]) == sample.attitude[:4]
    tilt, yaw = radians(0.4) ** 2, radians(0.5) ** 2
    assert imu["orientation_covariance"] == pytest.approx([tilt, 0, 0, 0, tilt, 0, 0, 0, yaw])
    rates = [radians(rate) for rate in (2.0 - 0.1, -3.0 - 0.2, 1.5 - 0.25)]
    assert list(imu["angular_velocity"].values()) == pytest.approx(rates)
    assert imu["angular_velocity_covariance"] == [0.0] * 9
    assert tuple(imu["linear_acceleration"].values()) == AXES[3:]
    assert imu["linear_acceleration_covariance"] == [0.0] * 9


def test_accelerations_that_are_missing_are_not_known(bridge: Rosbridge) -> None:
    outputs, client = bridge
    sample = tilted(seq=220)
    assert sample.attitude is not None
    attitude = sample.attitude._replace(tilt_sigma_deg=nan)
    rates = sample.sample._replace(inertial=AXES._replace(accel_y_mps2=nan))
    with subscribed(client):
        outputs.samples([sample._replace(sample=rates, attitude=attitude)])
        imu = imu_of(client)
    assert imu["linear_acceleration"] == {"x": 0.0, "y": 0.0, "z": 0.0}
    assert imu["linear_acceleration_covariance"][0] == -1.0
    assert imu["orientation_covariance"][0] == -1.0


def test_noise_of_three_axes_is_an_option() -> None:
    with bridged(",rate_sigma_dps=0.1,accel_sigma_mps2=0.2") as (outputs, client), subscribed(client):
        outputs.samples([tilted(seq=1)])
        imu = imu_of(client)
    rate = radians(0.1) ** 2 + radians(0.01) ** 2
    assert [imu["angular_velocity_covariance"][index] for index in (0, 4, 8)] == pytest.approx([rate] * 3)
    assert [imu["linear_acceleration_covariance"][index] for index in (0, 4, 8)] == pytest.approx([0.04] * 3)


def test_throttle_rate_is_the_least_time_between_messages(bridge: Rosbridge) -> None:
    outputs, client = bridge
    with subscribed(client, throttle_rate=25, id="slow"):
        outputs.samples([corrected(seq=item) for item in range(300, 310)])
        stamps = [imu_of(client)["header"]["stamp"]["nanosec"] for _ in range(4)]
        assert [round(stamp / 1e7) for stamp in stamps] == [0, 3, 6, 9]
        request(client, "subscribe", topic="/imu/data", id="fast")
        settled(client)
        outputs.samples([corrected(seq=item) for item in (311, 312)])
        assert [round(imu_of(client)["header"]["stamp"]["nanosec"] / 1e7) for _ in range(2)] == [11, 12]
        request(client, "unsubscribe", topic="/imu/data", id="fast")
        settled(client)
        outputs.samples([corrected(seq=item) for item in (313, 315)])
        assert round(imu_of(client)["header"]["stamp"]["nanosec"] / 1e7) == 15


def test_a_clock_that_begins_again_is_not_waited_for(bridge: Rosbridge) -> None:
    outputs, client = bridge
    with subscribed(client, throttle_rate=25):
        outputs.samples([corrected(seq=item) for item in (350, 10, 11, 13)])
        stamps = [imu_of(client)["header"]["stamp"]["nanosec"] for _ in range(3)]
    assert [round(stamp / 1e7) for stamp in stamps] == [50, 10, 13]


def test_a_topic_is_called_as_the_client_calls_it(bridge: Rosbridge) -> None:
    outputs, client = bridge
    with subscribed(client, topic="imu/data", type="sensor_msgs/Imu"):
        outputs.samples([corrected(seq=400)])
        assert heard(client)["topic"] == "imu/data"


def test_nothing_is_sent_after_unsubscribe(bridge: Rosbridge) -> None:
    outputs, client = bridge
    with subscribed(client):
        pass
    outputs.samples([corrected(seq=500)])
    outputs.statuses()
    assert service(client, "/rosapi/nodes")["op"] == "service_response", "nothing else comes before it"


def test_services_tell_what_there_is(bridge: Rosbridge) -> None:
    _, client = bridge
    topics = service(client, "/rosapi/topics")
    assert (topics["id"], topics["result"]) == ("s1", True)
    assert topics["values"] == {"topics": ["/imu/data"], "types": ["sensor_msgs/msg/Imu"]}
    assert service(client, "rosapi/topic_type", topic="/imu/data")["values"] == {"type": "sensor_msgs/msg/Imu"}
    assert service(client, "/rosapi/topics_for_type", type="sensor_msgs/Imu")["values"] == {"topics": ["/imu/data"]}
    for item in service(client, "/rosapi/services")["values"]["services"]:
        assert service(client, item)["result"] is True, item


def test_a_service_that_is_not_there_is_refused(bridge: Rosbridge) -> None:
    _, client = bridge
    refused = service(client, "/gyro/zero")
    assert refused["result"] is False
    assert "no service /gyro/zero; there are /rosapi/topics" in refused["values"]


@pytest.mark.parametrize(
    ("sent", "answer"),
    [
        ("}", "no JSON"),
        ("[" * 10_000, "no JSON"),
        ('{"op":"call_service","service":"/x","id":' + "[" * 500 + "]" * 500 + "}", "nested more than 16 deep"),
        ('{"op":"subscribe","id":' + "1" * 5000 + "}", "no JSON"),
        ('{"op":"\\ud800"}', "is not supported"),
        (b"\xff", "no JSON"),
        ("[]", 'expected an object with "op"'),
        ('{"op":"publish","topic":"/imu/data","msg":{}}', "publish is not supported"),
        ('{"op":"subscribe"}', "subscribe: expected a text 'topic'"),
        ('{"op":"subscribe","topic":"/tf"}', "no topic /tf; there is /imu/data"),
        ('{"op":"subscribe","topic":"/imu/data","type":"std_msgs/Int32"}', "is of type sensor_msgs/msg/Imu, not std"),
        ('{"op":"subscribe","topic":"/imu/data","throttle_rate":-1}', "throttle_rate: expected"),
        ('{"op":"subscribe","topic":"/imu/data","throttle_rate":NaN}', "no JSON"),
        ('{"op":"advertise","topic":"/imu/data","type":"std_msgs/Int32"}', "is published by gyrodrift, not as"),
        ('{"op":"set_level","level":"loud"}', "level: expected one of none, error, warning, info"),
    ],
)
def test_a_mistake_is_told_and_the_connection_stays(bridge: Rosbridge, sent: str | bytes, answer: str) -> None:
    _, client = bridge
    client.send(sent)
    status = heard(client)
    assert (status["op"], status["level"]) == ("status", "error")
    assert answer in status["msg"]
    settled(client)


def test_a_status_is_sent_to_who_asked_for_its_level(bridge: Rosbridge) -> None:
    _, client = bridge
    request(client, "advertise", topic="/cmd_vel", type="geometry_msgs/Twist")
    settled(client)
    request(client, "set_level", level="warning")
    request(client, "advertise", topic="/cmd_vel", type="geometry_msgs/Twist", id="a1")
    status = heard(client)
    assert (status["level"], status["id"]) == ("warning", "a1")
    request(client, "unadvertise", topic="/cmd_vel")
    request(client, "set_level", level="error")
    settled(client)


def test_names_noise_and_ros_are_options() -> None:
    with bridged(",topic=gyro,frame_id=base,ros=ros1,rate_sigma_dps=0.1") as (outputs, client):
        assert service(client, "/rosapi/topics")["values"] == {"topics": ["/gyro"], "types": ["sensor_msgs/Imu"]}
        with subscribed(client, topic="/gyro"):
            outputs.samples([corrected(seq=150, bias_sigma_dps=0.0)])
            imu = imu_of(client)
        assert imu["header"] == {"seq": 150, "stamp": {"secs": 1_700_000_001, "nsecs": 500_000_000}, "frame_id": "base"}
        assert imu["angular_velocity_covariance"][8] == pytest.approx(radians(0.1) ** 2)


def test_who_does_not_read_is_told_how_much_it_missed() -> None:
    with bridged() as (outputs, client):
        request(client, "subscribe", topic="/imu/data")
        settled(client)
        for first in range(0, 20_000, 100):
            outputs.samples([corrected(seq=item) for item in range(first, first + 100)])
        while not outputs.statuses()[0].dropped:
            pass
        outputs.samples([corrected(seq=20_000)])
        while (message := heard(client))["op"] == "publish":
            pass
        assert message["level"] == "error"
        assert "messages dropped: this client reads too slowly" in message["msg"]


@pytest.fixture
def config(tmp_path: Path) -> Path:
    path = tmp_path / "c.yaml"
    path.write_text(WITHOUT_BIAS)
    return path


def test_roslibpy_is_a_client(port: Path, config: Path) -> None:
    with serving(port, "--config", config, "--output", "rosbridge:port=0,ros=ros1") as (serve, device):
        host, number = address_of(serve, "rosbridge")
        statement = fed(python_client("roslibpy", "rosbridge_client.py", host, str(number), "25"), serve, device)
    assert statement["topics"] == {"/imu/data": "sensor_msgs/Imu"}
    assert "no service /rosapi/get_param" in statement["refused"]
    stamps_s = [
        item["header"]["stamp"]["secs"] + item["header"]["stamp"]["nsecs"] / 1e9 for item in statement["messages"]
    ]
    assert stamps_s == sorted(stamps_s)
    assert abs(statement["time_s"] - stamps_s[-1]) < 60.0
    seqs = [item["header"]["seq"] for item in statement["messages"]]
    assert min(b - a for a, b in pairwise(seqs)) >= 3
    assert statement["messages"][-1]["angular_velocity"]["z"] == pytest.approx(radians(10.0), rel=0.05)


def test_roslib_is_a_client(port: Path, config: Path) -> None:
    with serving(port, "--config", config, "--output", "rosbridge:port=0") as (serve, device):
        host, number = address_of(serve, "rosbridge")
        statement = fed(node_client("roslib", "rosbridge.mjs", f"ws://{host}:{number}"), serve, device)
    assert statement["topics"] == {"values": {"topics": ["/imu/data"], "types": ["sensor_msgs/msg/Imu"]}}
    assert statement["nodes"] == {"values": ["/gyrodrift"]}
    assert "no service /gyro/zero" in statement["refused"]["error"]
    assert statement["warned"]["level"] == "error"
    assert len(statement["messages"]) == 3
    assert statement["messages"][-1]["angular_velocity"]["z"] == pytest.approx(radians(10.0), rel=0.05)
