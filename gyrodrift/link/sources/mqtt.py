"""Source `mqtt://[USER@]BROKER[:PORT]/TOPIC`: messages of one topic, with text, JSON or frames. `mqtts://` uses TLS.

paho works without its thread: it reads when the loop of the service says so.
"""

import os
import re
import select
import time
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from secrets import token_hex
from socket import socket
from typing import TYPE_CHECKING, Any

from gyrodrift.io.files import UnreadableError, read_ordinary
from gyrodrift.io.paho_guard import PahoGuard
from gyrodrift.link.heard import LineEnds
from gyrodrift.link.port import PortGoneError
from gyrodrift.link.sources.source import ByteSource, SourceAddress, SourcePort
from gyrodrift.link.sources.stream_channel import (
    ANSWER_S,
    TLS_OPTIONS,
    connected_socket,
    host_and_path,
    tls_context,
)
from gyrodrift.values.errors import LinkError, UsageError

if TYPE_CHECKING:
    from paho.mqtt.client import Client, MQTTMessage

PLAIN_PORT, TLS_PORT = 1883, 8883
TLS = "mqtts"
OPTIONS = ("password_file", *TLS_OPTIONS)
PASSWORD_VARIABLE = "GYRODRIFT_MQTT_PASSWORD"  # noqa: S105 - the name of a variable
LONGEST_TEXT_BYTES = 0xFFFF
"""Longest topic or password in bytes: its length field has 16 bits."""

LONGEST_PACKET_BYTES = 64 << 10
"""Longest packet: a message of a gyro has some hundred bytes, and a batch of them some thousand."""

PACKETS_PER_READ, BYTES_PER_READ = 1024, 64 << 10
"""Largest number of packets, and of bytes before the last one, so that a flood does not block the loop."""

KEEP_ALIVE_S = 12
"""A broker is asked after so much silence, s, and counts as gone after so much more. Chosen."""

REASONS = {
    133: "it refuses the client name",
    134: "user name or password are wrong; check USER@ and password_file",
    135: "this user is not authorized; check USER@ and password_file",
    136: "it is not available",
}
"""Reasons by the codes of MQTT 5, which paho also gives for those of MQTT 3.1.1."""


class MqttPort(SourcePort):
    """Subscription to a topic, through a client that is connected by `connection`."""

    def __init__(self, path: str, client: "Client", connection: socket, topic: str) -> None:
        super().__init__(path, connection.fileno())
        self._client, self._connection, self._topic = client, connection, topic
        self._guard = PahoGuard(client, LONGEST_PACKET_BYTES)
        self._line_ends = LineEnds()
        self._arrived = bytearray()
        self._answers: list[Any] = []
        self._is_open = True
        client.on_connect = lambda _client, _data, _flags, code, _properties: self._answers.append(code)
        client.on_subscribe = lambda _client, _data, _mid, codes, _properties: self._answers.extend(codes)
        client.message_callback_add(topic, self._take)

    def log_in(self, host: str, port: int) -> None:
        """Connect and subscribe.

        Raises
        ------
        LinkError
            The broker refuses.
        """
        until_s = time.monotonic() + ANSWER_S
        self._client._create_socket = lambda: self._connection  # type: ignore[method-assign]  # noqa: SLF001 - no public name
        self._is_open = not self._client.connect(host, port, KEEP_ALIVE_S)
        code = self._answer(until_s)
        if code.is_failure:
            raise LinkError(
                f"{self.path}: the broker refuses the connection: {REASONS.get(code.value, f'it answers {code}')}"
            )
        self._client.subscribe(self._topic)
        if self._answer(until_s).is_failure:
            raise LinkError(f"{self.path}: the broker refuses the topic; may this user read it?")

    def read(self) -> bytes:
        """Messages that have arrived, up to a limit, without waiting."""
        self._follow()
        content = bytes(self._arrived)
        self._arrived.clear()
        self.wake_s = KEEP_ALIVE_S if self._guard.is_drained else 0.0
        if not self._is_open and not content:
            if self._guard.problem:
                self.note("source_refused", reason=self._guard.problem)
            raise PortGoneError(self.path)
        return content

    def close(self) -> None:
        """Close the connection."""
        self._guard.close()
        self._connection.close()

    def _take(self, _client: "Client", _data: Any, message: "MQTTMessage") -> None:
        """Keep a message, and drop those that flood the login; a retained one is old."""
        if message.payload and not message.retain and len(self._arrived) < BYTES_PER_READ:
            self._arrived += self._line_ends.add(bytes(message.payload))

    def _follow(self) -> None:
        """Handle the packets that have arrived, and ask a silent broker."""
        for _ in range(PACKETS_PER_READ):
            self._is_open = self._is_open and not self._client.loop_read()
            if self._guard.is_drained or not self._is_open or len(self._arrived) >= BYTES_PER_READ:
                break
        if self._client.want_write():
            self._client.loop_write()
        self._is_open = self._is_open and not self._client.loop_misc()

    def _answer(self, until_s: float) -> Any:
        """Code of the next answer; messages that come before are kept."""
        while not self._answers:
            left_s = until_s - time.monotonic()
            if left_s <= 0.0:
                raise LinkError(f"{self.path}: the server does not answer within {ANSWER_S:g} s")
            if not self._is_open:
                why = self._guard.problem or "the server closes the connection; is it another kind of server?"
                raise LinkError(f"{self.path}: this is no MQTT broker: {why}")
            select.select([self._connection], [], [], left_s)
            self._follow()
        return self._answers.pop(0)


def open_mqtt(address: SourceAddress) -> MqttPort:
    """Connect to a broker and subscribe.

    Raises
    ------
    UsageError
        The address has a mistake.
    LinkError
        The broker is absent or refuses; the message says why.
    """
    rest, options = address.split_query(OPTIONS)
    user, _, location = rest.rpartition("@")
    if ":" in user:
        raise UsageError(
            f"--port {address.scheme}://…: a password in an address is visible to all users of this machine; put it"
            f" into a file, and append ?password_file=FILE, or set {PASSWORD_VARIABLE}"
        )
    is_tls = address.scheme == TLS
    host, port, topic = host_and_path(address, location, TLS_PORT if is_tls else PLAIN_PORT)
    _check_topic(address, topic)
    client = _client(user, _password(address, options))
    connection = connected_socket(address, host, port, tls_context(address, options) if is_tls else None)
    subscription = MqttPort(address.text, client, connection, topic)
    try:
        subscription.log_in(host, port)
    except BaseException:
        subscription.close()
        raise
    return subscription


def _client(user: str, password: bytes) -> "Client":
    """Client with a new session."""
    from paho.mqtt.client import Client  # noqa: PLC0415 - a package of the extra
    from paho.mqtt.enums import CallbackAPIVersion  # noqa: PLC0415 - as above

    client = Client(CallbackAPIVersion.VERSION2, f"gyrodrift-{token_hex(4)}", reconnect_on_failure=False)
    if user:
        client.username_pw_set(user, password or None)  # type: ignore[arg-type]  # bytes are taken, too
    return client


def _check_topic(address: SourceAddress, topic: str) -> None:
    if not topic or len(topic.encode()) > LONGEST_TEXT_BYTES or re.search(r"[+#\x00]", topic):
        raise UsageError(
            f"--port {address.text}: expected {address.scheme}://[USER@]BROKER[:PORT]/TOPIC with one topic; several "
            "would mix their gyros"
        )


def _password(address: SourceAddress, options: Mapping[str, str]) -> bytes:
    if "password_file" not in options:
        return os.environ.get(PASSWORD_VARIABLE, "").encode("utf-8", "surrogateescape")[:LONGEST_TEXT_BYTES]
    path = options["password_file"]
    try:
        return read_ordinary(Path(path), LONGEST_TEXT_BYTES).content.rstrip(b"\r\n")
    except (OSError, UnreadableError) as error:
        raise UsageError(f"--port {address.text}: cannot read password_file={path}: {error}") from error


MQTT = ByteSource(
    "mqtt",
    "mqtt://[USER@]BROKER[:PORT]/TOPIC",
    "messages of one topic, with any text, JSON or frames",
    open_mqtt,
    packages=("paho",),
    extra="mqtt",
    silence="nothing is published on this topic; watch it with mosquitto_sub -v -t '#'",
)
MQTTS = replace(MQTT, scheme=TLS, title="mqtts://[USER@]BROKER[:PORT]/TOPIC", about="the same with TLS")
