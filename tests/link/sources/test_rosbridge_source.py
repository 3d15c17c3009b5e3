"""Source ws: our own rosbridge output, and a server of the library websockets that speaks the protocol."""

import json
import socket
import ssl
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from math import degrees, isnan, radians
from pathlib import Path
from typing import Any

import pytest
from broker_support import certificate, needs_openssl
from outputs_support import AXES, corrected, hub, tilted
from sources_support import PATIENCE_S, Events, Host, read_until, serving
from support import awaited

from gyrodrift.link.link import Link
from gyrodrift.link.options import LinkOptions
from gyrodrift.link.sources.rosbridge import ImuReadings, RosbridgePort, message_of, open_rosbridge
from gyrodrift.link.sources.source import SourceAddress
from gyrodrift.link.sources.stream_channel import StreamChannel
from gyrodrift.values.errors import DeviceSilentError, LinkError, PortMissingError, UsageError
from gyrodrift.values.sample import Corrected, Reading

pytest.importorskip("websockets", reason="websockets is not installed: pip install 'gyrodrift[websocket]'")

from websockets.exceptions import ConnectionClosed
from websockets.sync.server import ServerConnection, serve
from websockets.uri import parse_uri
from websockets.utils import accept_key

TOPIC = "/imu/data"
GRAVITY_MPS2 = 9.80665


def imu(t_ns: int, z_rads: float, **changed: Any) -> dict[str, Any]:
    """A message of ROS 2 as rosbridge sends it."""
    message: dict[str, Any] = {
        "header": {"stamp": {"sec": t_ns // 10**9, "nanosec": t_ns % 10**9}, "frame_id": "imu_link"},
        "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0},
        "orientation_covariance": [-1.0, *(0.0,) * 8],
        "angular_velocity": {"x": 0.1, "y": -0.2, "z": z_rads},
        "angular_velocity_covariance": [0.0] * 9,
        "linear_acceleration": {"x": 0.0, "y": 0.0, "z": GRAVITY_MPS2},
        "linear_acceleration_covariance": [0.0] * 9,
    }
    return {"op": "publish", "topic": TOPIC, "msg": message | changed}


def decoded(*publications: object) -> list[Reading]:
    readings = ImuReadings()
    messages = (message_of(json.dumps(publication).encode()) for publication in publications)
    return [reading for message in messages if message and (reading := readings.reading(message)) is not None]


class Bridge:
    """Server that accepts one subscription after the other and sends what the test says.

    requests
        Subscriptions so far.
    """

    def __init__(self, port: int, tls: ssl.SSLContext | None = None) -> None:
        self.requests: list[dict[str, Any]] = []
        self._clients: list[ServerConnection] = []
        self._server = serve(self._hold, "127.0.0.1", port, ssl=tls, close_timeout=0.1)
        self.port = self._server.socket.getsockname()[1]
        self._thread = threading.Thread(target=self._server.serve_forever)
        self._thread.start()

    def _hold(self, client: ServerConnection) -> None:
        try:
            self.requests.append(json.loads(client.recv(PATIENCE_S)))
            self._clients.append(client)
            for _ in client:
                pass
        except ConnectionClosed:
            pass

    def send(self, message: str | list[str]) -> None:
        """To the newest client; a list is a message in fragments."""
        awaited(lambda: self._clients)
        self._clients[-1].send(message)

    def close(self) -> None:
        self._server.shutdown()
        for client in self._clients:
            client.close()
        self._thread.join()


@contextmanager
def bridge(port: int = 0, tls: ssl.SSLContext | None = None) -> Iterator[Bridge]:
    with closing(Bridge(port, tls)) as server:
        yield server


@pytest.mark.parametrize("make", [tilted, corrected], ids=["three axes", "one axis"])
def test_our_own_rosbridge_output_is_read(make: Callable[[int], Corrected]) -> None:
    """Rates, accelerations and stamps that one service sends, another one reads."""
    with hub("rosbridge:port=0") as outputs:
        where = outputs.address
        with closing(Link(LinkOptions(f"ws://{where}{TOPIC}"), Events())) as link:
            number = iter(range(10**6))

            def has_enough(samples: list[Any]) -> bool:
                outputs.samples([make(next(number))])
                return len(samples) >= 20

            samples = read_until(link, has_enough)
    expected = (AXES.gyro_x_dps - 0.1, AXES.gyro_y_dps - 0.2, AXES.gyro_z_dps - 0.25, *AXES[3:])
    if make is tilted:
        assert samples[0].inertial == pytest.approx(expected, abs=1e-6)
    else:
        assert samples[0].rate_dps == pytest.approx(1.25)
    assert samples[1].t_device_s - samples[0].t_device_s == pytest.approx(0.01, abs=1e-4)


def test_the_topic_is_subscribed_with_its_type() -> None:
    """A server does not know the type before somebody publishes."""
    with bridge() as server, closing(Link(LinkOptions(f"ws://127.0.0.1:{server.port}{TOPIC}"), Events())) as link:
        server.send(json.dumps(imu(10**9, 0.5)))
        (sample,) = read_until(link, lambda samples: len(samples) == 1)
        assert server.requests == [{"op": "subscribe", "topic": TOPIC, "type": "sensor_msgs/Imu"}]
    assert sample.rate_dps == pytest.approx(degrees(0.5))
    assert link.device.device_id == "imu_link"


def test_a_message_in_fragments_is_one_message() -> None:
    text = json.dumps(imu(10**9, 0.5))
    with bridge() as server, closing(Link(LinkOptions(f"ws://127.0.0.1:{server.port}{TOPIC}"), Events())) as link:
        server.send([text[:50], text[50:60], text[60:]])
        assert len(read_until(link, lambda samples: len(samples) == 1)) == 1


def test_a_server_that_comes_back_is_read_again() -> None:
    events = Events()
    with bridge() as server:
        port = server.port
        link = Link(LinkOptions(f"ws://127.0.0.1:{port}{TOPIC}"), events)
        for step in range(100):
            server.send(json.dumps(imu(10**7 * step + 10**9, 0.5)))
        read_until(link, lambda samples: len(samples) == 100)
    read_until(link, lambda _: link.port is None)
    with bridge(port) as server:
        read_until(link, lambda _: link.port is not None)
        for step in range(150, 250):
            server.send(json.dumps(imu(10**7 * step + 10**9, 0.5)))
        samples = read_until(link, lambda samples: len(samples) >= 99)
        link.close()
    assert samples[-1].t_device_s == pytest.approx(3.49)
    assert (link.counters.reconnects, link.counters.gaps) == (1, 1)


def test_a_problem_of_the_server_is_reported_once() -> None:
    events = Events()
    with bridge() as server, closing(Link(LinkOptions(f"ws://127.0.0.1:{server.port}{TOPIC}"), events)) as link:
        for _ in range(3):
            server.send(json.dumps({"op": "status", "level": "error", "msg": "wrong type"}))
        server.send(json.dumps(imu(10**9, 0.5)))
        read_until(link, lambda samples: len(samples) == 1)
    problems = [fields["message"] for event, fields in events.told if event == "rosbridge_status"]
    assert problems == ["wrong type"]


def test_a_message_that_is_too_long_ends_the_connection() -> None:
    """The library refuses it before it is read."""
    events = Events()
    with bridge() as server, closing(Link(LinkOptions(f"ws://127.0.0.1:{server.port}{TOPIC}"), events)) as link:
        server.send("x" * (1 << 20))
        read_until(link, lambda _: link.port is None)
    assert "source_refused" in events.names()


@needs_openssl
def test_tls_is_checked(tmp_path: Path) -> None:
    made = certificate(tmp_path)
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(made, made.with_suffix(".key"))
    with bridge(tls=context) as server:
        address = f"wss://127.0.0.1:{server.port}{TOPIC}"
        with pytest.raises(LinkError, match=r"certificate of 127.0.0.1 is not trusted: .*; append \?ca=FILE"):
            Link(LinkOptions(address), Events())
        with closing(Link(LinkOptions(f"{address}?ca={made}"), Events())) as link:
            server.send(json.dumps(imu(10**9, 0.5)))
            assert len(read_until(link, lambda samples: len(samples) == 1)) == 1


def answered(answer: bytes) -> Callable[[socket.socket], None]:
    def run(server: socket.socket) -> None:
        connection, _ = server.accept()
        with connection:
            connection.recv(4096)
            connection.sendall(answer)

    return run


@pytest.mark.parametrize("answer", [b"HTTP/1.1 404 Not Found\r\nContent-Length: 0\r\n\r\n", b"\x00" * 20, b""])
def test_another_server_is_an_error(answer: bytes) -> None:
    with serving() as server:
        thread = threading.Thread(target=answered(answer), args=(server,))
        thread.start()
        with pytest.raises(LinkError, match=r"this is no rosbridge server|closes the connection"):
            Link(LinkOptions(f"ws://127.0.0.1:{server.getsockname()[1]}{TOPIC}"), Events())
        thread.join()


def test_a_server_that_is_not_there_is_an_error() -> None:
    with serving() as server:
        port = server.getsockname()[1]
    with pytest.raises(PortMissingError, match=f"nothing listens on port {port} of 127.0.0.1"):
        Link(LinkOptions(f"ws://127.0.0.1:{port}{TOPIC}"), Events())


@pytest.mark.parametrize("text", ["ws://127.0.0.1:9090", "ws://127.0.0.1:9090/", "ws://127.0.0.1"])
def test_an_address_without_a_topic_is_an_error(text: str) -> None:
    with pytest.raises(UsageError, match=r"expected ws://HOST\[:9090\]/TOPIC, such as /imu/data"):
        Link(LinkOptions(text), Events())


def test_a_topic_without_messages_is_an_error_with_advice() -> None:
    silence = pytest.raises(DeviceSilentError, match="nothing is published on this topic; list the topics")
    with bridge() as server, Host(f"ws://127.0.0.1:{server.port}{TOPIC}", timeout_s=3.0) as host, silence:
        host.read(3.0)


def test_stamps_of_both_versions_are_the_clock() -> None:
    old = imu(0, 0.5, header={"stamp": {"secs": 5, "nsecs": 7000}, "frame_id": ""})
    assert [reading.t_us for reading in decoded(imu(5_000_007_000, 0.5), old)] == [5_000_007, 5_000_007]


def test_a_driver_without_stamps_has_no_clock() -> None:
    assert [reading.t_us for reading in decoded(imu(0, 0.5), imu(5 * 10**9, 0.5))] == [None, None]
    assert [reading.t_us for reading in decoded(imu(10**9, 0.5), imu(0, 0.5))] == [1_000_000]


def test_a_missing_measurement_is_marked_by_its_covariance() -> None:
    missing = [-1.0, *(0.0,) * 8]
    (reading,) = decoded(imu(1, 0.5, linear_acceleration_covariance=missing))
    assert reading.inertial is not None
    assert isnan(reading.inertial.accel_z_mps2)
    assert decoded(imu(1, 0.5, angular_velocity_covariance=missing)) == []


@pytest.mark.parametrize(
    "publication",
    [
        {},
        [],
        "x",
        {"msg": []},
        imu(1, 1e300),
        imu(1, 0.5, angular_velocity={"x": 0.0, "y": None, "z": 1.0}),
        imu(1, 0.5, angular_velocity={"x": 0.0, "y": float("nan"), "z": 1.0}),
        imu(1, 0.5, angular_velocity={"x": 0.0, "y": 10**400, "z": 1.0}),
        imu(1, 0.5, angular_velocity=[0.0, 0.0, 1.0]),
    ],
    ids=str,
)
def test_a_hostile_message_is_no_reading(publication: object) -> None:
    assert decoded(publication) == []


@pytest.mark.parametrize("stamp", [None, 5, {"sec": "5", "nanosec": 0}, {"sec": 1 << 80, "nanosec": 1}, {"sec": 1.5}])
def test_a_hostile_stamp_is_none(stamp: object) -> None:
    (reading,) = decoded(imu(1, 0.5, header={"stamp": stamp, "frame_id": "x" * 10_00}))
    assert reading.t_us is None
    assert reading.rate_dps == pytest.approx(degrees(0.5))


def test_deeply_nested_json_is_damage() -> None:
    with bridge() as server, closing(Link(LinkOptions(f"ws://127.0.0.1:{server.port}{TOPIC}"), Events())) as link:
        server.send('"publish"' + "[" * 4000)
        server.send(json.dumps(imu(1, radians(1.0))))
        read_until(link, lambda samples: len(samples) == 1)
        assert link.decoder is not None
        assert (link.decoder.counters.frames, link.decoder.counters.damaged) == (1, 1)


def answer_handshake(connection: socket.socket, frames: bytes) -> None:
    """Answer as a server, send these bytes with the answer, and read to the end."""
    key = connection.recv(4096).partition(b"Sec-WebSocket-Key: ")[2].partition(b"\r\n")[0]
    head = "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
    accept = f"{head}Sec-WebSocket-Accept: {accept_key(key.decode())}\r\n\r\n"
    connection.sendall(accept.encode() + frames)
    while connection.recv(4096):
        pass


@contextmanager
def raw_server(frames: bytes) -> Iterator[SourceAddress]:
    """A server that answers the handshake and sends these bytes with its answer."""

    def answer(server: socket.socket) -> None:
        connection, _ = server.accept()
        with connection:
            answer_handshake(connection, frames)

    with serving() as server:
        thread = threading.Thread(target=answer, args=(server,))
        thread.start()
        rest = f"127.0.0.1:{server.getsockname()[1]}{TOPIC}"
        yield SourceAddress(f"ws://{rest}", "ws", rest)
        thread.join()


def test_frames_without_content_are_not_kept() -> None:
    """A message may have any number of empty parts."""
    publication = json.dumps({"op": "publish", "msg": {}}).encode()
    frames = b"\x01\x00" + b"\x00\x00" * 1000
    with (
        raw_server(frames + bytes((0x80, len(publication))) + publication) as where,
        closing(open_rosbridge(where)) as subscription,
    ):
        until_s = time.monotonic() + PATIENCE_S
        while not (content := subscription.read()):
            assert len(subscription._parts) == 0
            assert time.monotonic() < until_s
    assert content.messages == [publication]


def test_a_server_that_breaks_the_rules_at_once_is_refused_with_its_reason() -> None:
    near, far = socket.socketpair()
    with near, far:
        subscription = RosbridgePort(StreamChannel("ws://peer", near), parse_uri("ws://peer/"))
        broken = b"\x81\x7f" + (100 << 20).to_bytes(8, "big")
        thread = threading.Thread(target=answer_handshake, args=(far, broken))
        thread.start()
        with pytest.raises(LinkError, match=r"ws://peer: .*exceeds limit of 65536 bytes"):
            subscription.subscribe(TOPIC)
        near.close()
        thread.join()
