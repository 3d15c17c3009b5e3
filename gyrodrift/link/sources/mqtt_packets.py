"""Packets of MQTT 3.1.1 that a subscriber needs. Without acknowledgments it is a small protocol.

Source: OASIS MQTT Version 3.1.1, chapters 2 and 3.
"""

from typing import NamedTuple

CONNACK, PUBLISH, SUBACK, PINGRESP = 2, 3, 9, 13
PING = b"\xc0\x00"
CONNECT_TYPE, SUBSCRIBE_TYPE = 0x10, 0x82
CLEAN_SESSION, HAS_PASSWORD, HAS_USER = 0x02, 0x40, 0x80
RETAINED, QUALITY = 0x01, 0x06
REFUSED = 0x80

LONGEST_PACKET_BYTES = 64 << 10
"""Longest packet: a message of a gyro has some hundred bytes, and a batch of them some thousand."""


class MqttPacket(NamedTuple):
    """Packet of a broker, without its length."""

    kind: int
    flags: int
    content: bytes


class MqttStream:
    """Splits a stream into packets.

    problem
        Reason why the rest cannot be read; empty if it can.
    """

    def __init__(self) -> None:
        self.problem = ""
        self._pending = b""

    def push(self, chunk: bytes) -> list[MqttPacket]:
        """Complete packets; an incomplete one waits."""
        content, position, packets = self._pending + chunk, 0, list[MqttPacket]()
        while not self.problem:
            head = _length(content, position + 1)
            if head is None:
                break
            start, length = head
            if length < 0 or length > LONGEST_PACKET_BYTES:
                self.problem = f"the broker sends a packet of more than {LONGEST_PACKET_BYTES} bytes"
            if len(content) - start < length:
                break
            first = content[position]
            packets.append(MqttPacket(first >> 4, first & 0xF, content[start : start + length]))
            position = start + length
        self._pending = b"" if self.problem else content[position:]
        return packets


def _length(content: bytes, position: int) -> tuple[int, int] | None:
    """Start and length of the rest of a packet, a number of one to four bytes; None if bytes are missing."""
    length = 0
    for index in range(4):
        if position + index >= len(content):
            return None
        byte = content[position + index]
        length |= (byte & 0x7F) << 7 * index
        if byte < 0x80:
            return position + index + 1, length
    return position, -1


def connect_packet(client: str, user: str, password: bytes, keep_alive_s: int) -> bytes:
    """CONNECT with a new session."""
    flags = CLEAN_SESSION | (HAS_USER if user else 0) | (HAS_PASSWORD if user and password else 0)
    texts = [client.encode(), *([user.encode()] if user else []), *([password] if user and password else [])]
    content = _text(b"MQTT") + bytes((4, flags)) + keep_alive_s.to_bytes(2, "big") + b"".join(map(_text, texts))
    return _packet(CONNECT_TYPE, content)


def subscribe_packet(topic: str) -> bytes:
    """SUBSCRIBE to a topic, at most once delivery."""
    return _packet(SUBSCRIBE_TYPE, b"\x00\x01" + _text(topic.encode()) + b"\x00")


def payload_of(packet: MqttPacket, topic: bytes) -> bytes | None:
    """Payload of a PUBLISH of a topic; None for other packets, and for a retained message, which is old."""
    if packet.kind != PUBLISH or packet.flags & (RETAINED | QUALITY):
        return None
    size = int.from_bytes(packet.content[:2], "big")
    return packet.content[2 + size :] if packet.content[2 : 2 + size] == topic else None


def _text(content: bytes) -> bytes:
    return len(content).to_bytes(2, "big") + content


def _packet(first: int, content: bytes) -> bytes:
    length, size = b"", len(content)
    while True:
        size, digit = divmod(size, 0x80)
        length += bytes((digit | (0x80 if size else 0),))
        if not size:
            return bytes((first,)) + length + content
