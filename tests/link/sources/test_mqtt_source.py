"""Source mqtt with a real broker, mosquitto, and its own client, mosquitto_pub."""

import select
import shutil
import socket
import subprocess
import threading
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from functools import partial
from pathlib import Path

import pytest
from broker_support import broker, certificate, need_mosquitto, needs_openssl
from sources_support import PATIENCE_S, Events, Host, lines, read_until
from support import free_port

from gyrodrift.link.link import Link
from gyrodrift.link.options import LinkOptions
from gyrodrift.link.port import PortGoneError
from gyrodrift.link.sources.mqtt import KEEP_ALIVE_S, PASSWORD_VARIABLE, MqttPort, open_mqtt
from gyrodrift.link.sources.source import SourceAddress
from gyrodrift.values.errors import DeviceSilentError, LinkError, PortMissingError, UsageError

need_mosquitto()
pytest.importorskip("paho", reason="paho-mqtt is not installed: pip install 'gyrodrift[mqtt]'")

TOPIC = "robot/gyro"
PING = b"\xc0\x00"


@pytest.fixture
def number() -> int:
    """A port that nobody has."""
    return free_port()


def publish(number: int, content: bytes, *options: str) -> None:
    """Publish each line as a message; the client may hang once its input has ended (mosquitto 2.0.11)."""
    command = ["mosquitto_pub", "-h", "127.0.0.1", "-p", str(number), "-t", TOPIC, "-l", *options]
    with suppress(subprocess.TimeoutExpired):
        subprocess.run(command, input=content, check=True, timeout=PATIENCE_S / 4.0)


def test_messages_of_a_topic_are_read_like_a_cable(number: int, tmp_path: Path) -> None:
    """A line per message, without its line end."""
    events = Events()
    with broker(number, tmp_path), closing(Link(LinkOptions(f"mqtt://127.0.0.1:{number}/{TOPIC}"), events)) as link:
        publish(number, lines(0, 200))
        samples = read_until(link, lambda samples: len(samples) == 200)
    assert [sample.seq for sample in samples] == list(range(200))
    assert ("protocol_found", {"protocol": "csv"}) in events.told


def test_json_is_read_by_columns(number: int, tmp_path: Path) -> None:
    options = LinkOptions(f"mqtt://127.0.0.1:{number}/{TOPIC}", columns="time=t_s, gyro.z=rate:dps")
    with broker(number, tmp_path), closing(Link(options, Events())) as link:
        publish(number, b"".join(b'{"time": %g, "gyro": {"z": 2.5}}\n' % (0.01 * step) for step in range(50)))
        samples = read_until(link, lambda samples: len(samples) == 50)
    assert samples[-1].rate_dps == 2.5


def test_a_retained_message_is_old_and_no_sample(number: int, tmp_path: Path) -> None:
    with broker(number, tmp_path):
        command = ["mosquitto_pub", "-h", "127.0.0.1", "-p", str(number), "-t", TOPIC, "-r", "-m", "99,77.0"]
        subprocess.run(command, check=True, timeout=PATIENCE_S)
        with closing(Link(LinkOptions(f"mqtt://127.0.0.1:{number}/{TOPIC}"), Events())) as link:
            publish(number, lines(0, 50))
            samples = read_until(link, lambda samples: len(samples) == 50)
    assert {sample.rate_dps for sample in samples} == {0.5}


def test_a_broker_that_comes_back_is_read_again(number: int, tmp_path: Path) -> None:
    events = Events()
    with broker(number, tmp_path):
        link = Link(LinkOptions(f"mqtt://127.0.0.1:{number}/{TOPIC}"), events)
        publish(number, lines(0, 100))
        read_until(link, lambda samples: len(samples) == 100)
    read_until(link, lambda _: link.port is None)
    with broker(number, tmp_path):
        read_until(link, lambda _: link.port is not None)
        publish(number, lines(150, 100))
        samples = read_until(link, lambda samples: len(samples) >= 99)
        link.close()
    assert samples[-1].t_device_s == pytest.approx(2.49)
    assert (link.counters.reconnects, link.counters.gaps) == (1, 1)
    assert events.names().count("link_restored") == 1


@pytest.mark.skipif(shutil.which("mosquitto_passwd") is None, reason="mosquitto_passwd is not installed")
def test_a_password_comes_from_a_file_or_the_environment(
    number: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    users, secret = tmp_path / "users", tmp_path / "secret"
    subprocess.run(["mosquitto_passwd", "-b", "-c", str(users), "ann", "s3cret"], check=True, capture_output=True)
    secret.write_text("s3cret\n")
    address = f"mqtt://ann@127.0.0.1:{number}/{TOPIC}"
    with broker(number, tmp_path, "allow_anonymous false", f"password_file {users}"):
        Link(LinkOptions(f"{address}?password_file={secret}"), Events()).close()
        monkeypatch.setenv(PASSWORD_VARIABLE, "s3cret")
        Link(LinkOptions(address), Events()).close()
        monkeypatch.setenv(PASSWORD_VARIABLE, "wr0ng")
        with pytest.raises(LinkError, match=r"refuses the connection: .*check USER@ and password_file"):
            Link(LinkOptions(address), Events())


@needs_openssl
def test_a_certificate_is_checked(number: int, tmp_path: Path) -> None:
    made = certificate(tmp_path)
    settings = ("allow_anonymous true", f"certfile {made}", f"keyfile {made.with_suffix('.key')}")
    with broker(number, tmp_path, *settings):
        address = f"mqtts://127.0.0.1:{number}/{TOPIC}"
        with pytest.raises(LinkError, match=r"certificate of 127.0.0.1 is not trusted: .*; append \?ca=FILE"):
            Link(LinkOptions(address), Events())
        with closing(Link(LinkOptions(f"{address}?ca={made}"), Events())) as link:
            publish(number, lines(0, 2000), "--cafile", str(made))
            assert len(read_until(link, lambda samples: len(samples) == 2000)) == 2000


@needs_openssl
def test_a_certificate_of_the_client_is_shown(number: int, tmp_path: Path) -> None:
    made = certificate(tmp_path)
    key = made.with_suffix(".key")
    settings = (
        "allow_anonymous true",
        f"certfile {made}",
        f"keyfile {key}",
        f"cafile {made}",
        "require_certificate true",
    )
    address = f"mqtts://127.0.0.1:{number}/{TOPIC}?ca={made}"
    with broker(number, tmp_path, *settings):
        with pytest.raises(LinkError, match=r"(server|broker) ends the connection|no TLS|closes the connection"):
            Link(LinkOptions(address), Events())
        Link(LinkOptions(f"{address}&certificate={made}&key={key}"), Events()).close()


def test_tls_without_a_certificate_is_an_error(number: int, tmp_path: Path) -> None:
    with broker(number, tmp_path), pytest.raises(LinkError, match=r"no TLS with 127.0.0.1: .*a port without TLS"):
        Link(LinkOptions(f"mqtts://127.0.0.1:{number}/{TOPIC}"), Events())


def test_a_broker_that_is_not_there_is_an_error(number: int) -> None:
    with pytest.raises(PortMissingError, match=rf"nothing listens on port {number} of 127.0.0.1"):
        Link(LinkOptions(f"mqtt://127.0.0.1:{number}/{TOPIC}"), Events())


def test_a_topic_without_messages_is_an_error_with_advice(number: int, tmp_path: Path) -> None:
    silence = pytest.raises(DeviceSilentError, match="nothing is published on this topic")
    with broker(number, tmp_path), Host(f"mqtt://127.0.0.1:{number}/{TOPIC}", timeout_s=3.0) as host, silence:
        host.read(3.0)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("mqtt://ann:s3cret@host/topic", r"a password in an address is visible .* \?password_file=FILE"),
        ("mqtt://host", r"expected mqtt://\[USER@\]BROKER\[:PORT\]/TOPIC"),
        ("mqtt://host/robot/+", "with one topic; several would mix their gyros"),
        ("mqtt://host:x/topic", "expected mqtt://HOST:PORT with a port from 1 to 65535"),
        ("mqtt://host/topic?password_file=/nowhere", "cannot read password_file=/nowhere"),
        ("mqtts://host/topic?ca=/nowhere", "cannot use ca=/nowhere"),
    ],
)
def test_a_wrong_address_is_an_error(text: str, expected: str) -> None:
    with pytest.raises(UsageError, match=expected) as error:
        Link(LinkOptions(text), Events())
    assert "s3cret" not in str(error.value)


@contextmanager
def hostile(answer: bytes) -> Iterator[int]:
    """A server that reads a little, answers, and closes."""

    def serve() -> None:
        connection, _ = server.accept()
        with connection:
            connection.settimeout(PATIENCE_S)
            connection.recv(1000)
            connection.sendall(answer)

    with socket.create_server(("127.0.0.1", 0)) as server:
        thread = threading.Thread(target=serve)
        thread.start()
        yield server.getsockname()[1]
        thread.join()


@pytest.mark.parametrize(
    ("answer", "expected"),
    [
        (b"HTTP/1.1 400 Bad Request\r\n\r\n", "closes the connection; is it another kind of server"),
        (b"\x20\xff\xff\xff\xff", "this is no MQTT broker"),
        (b"\x20\x02\x00\x07", "refuses the connection: it answers Unspecified error"),
        (b"", "closes the connection"),
    ],
)
def test_another_server_is_an_error(answer: bytes, expected: str) -> None:
    with hostile(answer) as port, pytest.raises(LinkError, match=expected):
        Link(LinkOptions(f"mqtt://127.0.0.1:{port}/{TOPIC}"), Events())


@contextmanager
def subscription() -> Iterator[tuple[MqttPort, socket.socket]]:
    """Port whose broker the test plays, after its answers."""
    accepted: list[socket.socket] = []

    def serve(server: socket.socket) -> None:
        broker, _ = server.accept()
        broker.settimeout(PATIENCE_S)
        accepted.append(broker)
        for answer in (b"\x20\x02\x00\x00", b"\x90\x03\x00\x01\x00"):
            broker.recv(1000)
            broker.sendall(answer)

    with socket.create_server(("127.0.0.1", 0)) as server:
        thread = threading.Thread(target=serve, args=(server,))
        thread.start()
        rest = f"127.0.0.1:{server.getsockname()[1]}/x"
        with closing(open_mqtt(SourceAddress(f"mqtt://{rest}", "mqtt", rest))) as port:
            thread.join()
            with accepted[0]:
                yield port, accepted[0]


def read_bytes(port: MqttPort) -> bytes:
    """Content of the next message, which must come soon."""
    select.select([port.fd or 0], [], [], PATIENCE_S)
    return port.read()


def test_a_silent_broker_is_asked_and_then_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    now_s = time.monotonic()
    with subscription() as (port, theirs):
        monkeypatch.setattr("paho.mqtt.client.time_func", lambda: now_s)
        now_s += KEEP_ALIVE_S + 1
        assert port.read() == b""
        assert theirs.recv(10) == PING
        theirs.sendall(b"\xd0\x00")
        assert read_bytes(port) == b""
        now_s += KEEP_ALIVE_S
        assert port.read() == b""
        now_s += KEEP_ALIVE_S
        with pytest.raises(PortGoneError):
            port.read()


def test_a_packet_of_256_mb_ends_the_connection() -> None:
    with subscription() as (port, theirs):
        theirs.sendall(b"\x30\xff\xff\xff\x7f" + bytes(1000))
        with pytest.raises(PortGoneError):
            read_bytes(port)
        assert port.notes[0][0] == "source_refused"


def test_a_flood_does_not_hold_the_loop() -> None:
    with subscription() as (port, theirs):
        message = b"\x30\x83\x40\x00\x01x" + bytes(8192)
        thread = threading.Thread(target=theirs.sendall, args=(message * 40,))
        thread.start()
        sizes: list[int] = []
        while sum(sizes) < 40 * 8192:
            sizes.append(len(read_bytes(port)))
        thread.join()
    assert max(sizes) <= 64 << 10


def test_a_broker_that_wants_answers_without_end_is_left() -> None:
    """Messages of the highest quality of service wait for its last word."""
    with subscription() as (port, theirs):
        for number in range(1, 400):
            theirs.sendall(b"\x34\x05\x00\x01x" + number.to_bytes(2, "big"))
        with pytest.raises(PortGoneError):
            b"".join(iter(partial(read_bytes, port), b"never"))
        assert "wait for an answer" in port.notes[0][1]["reason"]


def test_messages_of_other_topics_and_other_packets_are_ignored() -> None:
    with subscription() as (port, theirs):
        theirs.sendall(
            b"\x30\x05\x00\x01yab\xd0\x00\x31\x05\x00\x01xcd\x30\x05\x00\x01\xffab\x30\x03\x00\x01x\x30\x05\x00\x01xab"
        )
        content = b""
        while not content:
            content = read_bytes(port)
    assert content == b"ab\n"
