"""Source `mqtt://[USER@]BROKER[:PORT]/TOPIC`: messages of one topic, with text, JSON or frames. `mqtts://` uses TLS."""

import os
import re
import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from secrets import token_hex

from gyrodrift.io.files import UnreadableError, read_ordinary
from gyrodrift.link.port import PortGoneError
from gyrodrift.link.sources.line_ends import LineEnds
from gyrodrift.link.sources.mqtt_packets import (
    CONNACK,
    PING,
    REFUSED,
    SUBACK,
    MqttPacket,
    MqttStream,
    connect_packet,
    payload_of,
    subscribe_packet,
)
from gyrodrift.link.sources.query import split_query
from gyrodrift.link.sources.source import ByteSource, SourceAddress, SourcePort
from gyrodrift.link.sources.stream_channel import TLS_OPTIONS, StreamChannel, host_and_path, open_channel, tls_context
from gyrodrift.values.errors import LinkError, UsageError

PLAIN_PORT, TLS_PORT = 1883, 8883
TLS = "mqtts"
OPTIONS = ("password_file", *TLS_OPTIONS)
PASSWORD_VARIABLE = "GYRODRIFT_MQTT_PASSWORD"  # noqa: S105 - the name of a variable
LONGEST_TEXT_BYTES = 0xFFFF
"""Longest topic or password in bytes: its length field has 16 bits."""

KEEP_ALIVE_S = 30
PING_S, GONE_S = 10.0, 25.0
"""A broker is asked after so much silence, s, and counts as gone after so much more. Chosen."""

REASONS = {
    1: "it does not speak MQTT 3.1.1",
    2: "it refuses the client name",
    3: "it is not available",
    4: "user name or password are wrong; check USER@ and password_file",
    5: "this user is not authorized; check USER@ and password_file",
}
"""Return codes of CONNACK."""


class MqttPort(SourcePort):
    """Subscription to a topic."""

    def __init__(self, channel: StreamChannel, topic: str, monotonic: Callable[[], float] = time.monotonic) -> None:
        super().__init__(channel.path, channel.fd)
        self._channel = channel
        self._topic = topic.encode()
        self._stream = MqttStream()
        self._line_ends = LineEnds()
        self._monotonic = monotonic
        self._heard_s = self._asked_s = monotonic()
        self._early: list[MqttPacket] = []

    def log_in(self, user: str, password: bytes) -> None:
        """Connect and subscribe.

        Raises
        ------
        LinkError
            The broker refuses.
        """
        self._channel.send(connect_packet(f"gyrodrift-{token_hex(4)}", user, password, KEEP_ALIVE_S))
        code = self._answer(CONNACK)[1]
        if code:
            reason = REASONS.get(code, f"it answers {code}")
            raise LinkError(f"{self.path}: the broker refuses the connection: {reason}")
        self._channel.send(subscribe_packet(self._topic.decode()))
        if self._answer(SUBACK)[-1] & REFUSED:
            raise LinkError(f"{self.path}: the broker refuses the topic; may this user read it?")
        self._channel.start()

    def read(self) -> bytes:
        """Messages that have arrived, up to a limit, without waiting."""
        chunk = self._channel.receive()
        self.wake_s = 0.0 if self._channel.has_more else PING_S
        self._keep_alive(bool(chunk))
        packets, self._early = [*self._early, *self._stream.push(chunk)], []
        if self._stream.problem:
            self.note("source_refused", reason=self._stream.problem)
            raise PortGoneError(self.path)
        payloads = (payload_of(packet, self._topic) for packet in packets)
        return b"".join(self._line_ends.add(payload) for payload in payloads if payload)

    def close(self) -> None:
        """Close the connection."""
        self._channel.close()

    def _keep_alive(self, is_heard: bool) -> None:  # noqa: FBT001 - private, one caller
        now_s = self._monotonic()
        if is_heard:
            self._heard_s = now_s
        elif now_s - self._heard_s >= GONE_S:
            raise PortGoneError(self.path)
        if now_s - self._asked_s >= PING_S:
            self._asked_s = now_s
            self._channel.send(PING)

    def _answer(self, kind: int) -> bytes:
        """Content of the answer of a kind; messages that come before are kept."""
        until_s = self._monotonic() + GONE_S
        while self._monotonic() < until_s and not self._stream.problem:
            packets = self._stream.push(self._channel.wait())
            for index, packet in enumerate(packets):
                if packet.kind == kind and len(packet.content) > 1:
                    self._early += packets[index + 1 :]
                    return packet.content
        raise LinkError(f"{self.path}: this is no MQTT broker, or it does not answer")


def open_mqtt(address: SourceAddress) -> MqttPort:
    """Connect to a broker and subscribe.

    Raises
    ------
    UsageError
        The address has a mistake.
    LinkError
        The broker is absent or refuses; the message says why.
    """
    rest, options = split_query(address, OPTIONS)
    user, _, location = rest.rpartition("@")
    if ":" in user:
        raise UsageError(
            f"--port {address.scheme}://…: a password in an address is visible to all users of this machine; put it"
            f" into a file, and append ?password_file=FILE, or set {PASSWORD_VARIABLE}"
        )
    is_tls = address.scheme == TLS
    host, port, topic = host_and_path(address, location, TLS_PORT if is_tls else PLAIN_PORT)
    _check_topic(address, topic)
    password = _password(address, options)
    channel = open_channel(address, host, port, tls_context(address, options) if is_tls else None)
    try:
        subscription = MqttPort(channel, topic)
        subscription.log_in(user, password)
    except PortGoneError as error:
        channel.close()
        raise LinkError(f"{address.text}: the broker ends the connection") from error
    except BaseException:
        channel.close()
        raise
    return subscription


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
    silence="nothing is published on this topic; watch it with mosquitto_sub -v -t '#'",
)
MQTTS = replace(MQTT, scheme=TLS, title="mqtts://[USER@]BROKER[:PORT]/TOPIC", about="the same with TLS")
