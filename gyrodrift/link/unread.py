"""Known protocols that are not read, with advice, so that the baud rate is not blamed.

One record per protocol. A stream belongs to it if it has FRAMES_MIN frames with a right checksum.
"""

import re
import zlib
from binascii import crc_hqx
from collections.abc import Callable
from dataclasses import dataclass
from itertools import accumulate

from gyrodrift.link.protocols.sentences import checksum

FRAMES_MIN = 3
LONGEST_HEADER = 256
FAILED_MAX = 300
"""Largest number of heads without a frame; a real stream has three good frames long before."""


@dataclass(frozen=True, slots=True)
class UnreadProtocol:
    """Known protocol that is not read.

    name
        Name and device.
    head
        Pattern of the beginning of a frame.
    length
        Function that returns the length of a frame from its first LONGEST_HEADER bytes; 0 if it is not a frame.
    is_whole
        Function that checks a frame.
    advice
        Setting of the device, or program that reads it.
    chained
        Function that returns the frame counter; consecutive frames must then follow directly. None if the checksum is
        enough.
    status
        Clause about the support in gyrodrift.
    """

    name: str
    head: re.Pattern[bytes]
    length: Callable[[bytes], int]
    is_whole: Callable[[bytes], bool]
    advice: str
    chained: Callable[[bytes], int] | None = None
    status: str = "which gyrodrift does not read"

    @property
    def message(self) -> str:
        """Name and advice."""
        return f"the device sends {self.name}, {self.status}; {self.advice}"

    def is_spoken(self, content: bytes) -> bool:
        """Whether the bytes belong to this protocol."""
        frames, position, before, failed = 0, 0, -1, 0
        while failed < FAILED_MAX and (match := self.head.search(content, position)) is not None:
            begin = match.start()
            length = self.length(content[begin : begin + LONGEST_HEADER])
            frame = content[begin : begin + length]
            if not length or len(frame) < length or not self.is_whole(frame):
                position, frames, before = begin + 1, 0 if self.chained else frames, -1
                failed += 1
                continue
            if self.chained is not None:
                count = self.chained(frame)
                goes_on = begin == position and count == (before + 1) & 0xFF
                frames, before = frames if goes_on else 0, count
            position, frames = begin + length, frames + 1
            if frames > FRAMES_MIN - (self.chained is None):
                return True
        return False


def spoken(content: bytes) -> UnreadProtocol | None:
    """Protocol of the bytes; None if it is unknown."""
    return next((protocol for protocol in UNREAD if protocol.is_spoken(content)), None)


def _fletcher(content: bytes) -> bytes:
    """Two sums modulo 256 (RFC 1145)."""
    sums = list(accumulate(content))
    return bytes((sums[-1] & 0xFF, sum(sums) & 0xFF))


def _snp_length(header: bytes) -> int:
    """UM7 data sheet, packet type: has data, is a batch, registers of the batch."""
    kind = header[3] if len(header) > 3 else 0
    registers = (kind >> 2 & 0xF) if kind & 0x40 else 1
    return 7 + (4 * registers if kind & 0x80 else 0)


def _word(header: bytes, position: int, extra: int) -> int:
    """Length from two little-endian bytes, plus `extra`."""
    return extra + int.from_bytes(header[position : position + 2], "little") if len(header) >= position + 2 else 0


def _byte(header: bytes, position: int, extra: int) -> int:
    return extra + header[position] if len(header) > position else 0


def _crc24q_of(byte: int) -> int:
    crc = byte << 16
    for _ in range(8):
        crc = crc << 1 ^ (0x1864CFB if crc & 0x800000 else 0)
    return crc


CRC24Q = tuple(map(_crc24q_of, range(256)))
"""RTCM 10403, polynomial 0x1864CFB, by bytes."""


def _crc24q(content: bytes) -> int:
    """CRC-24Q; 0 for a frame with its CRC."""
    crc = 0
    for byte in content:
        crc = crc << 8 & 0xFFFFFF ^ CRC24Q[crc >> 16 ^ byte]
    return crc


def _crc32_from_0(content: bytes) -> int:
    return zlib.crc32(content, 0xFFFFFFFF) ^ 0xFFFFFFFF


def _is_rosserial(frame: bytes) -> bool:
    """Check the sums of length, and of topic and message (ROS wiki, rosserial protocol)."""
    return sum(frame[2:5]) & 0xFF == 0xFF and sum(frame[5:]) & 0xFF == 0xFF


def _line_length(header: bytes) -> int:
    return header.find(b"\n") + 1


def _is_navx(frame: bytes) -> bool:
    """Check the sum of all characters before it, in hexadecimal digits."""
    return b"%02X" % (sum(frame[:-4]) & 0xFF) == frame[-4:-2].upper()


def _is_sentence(frame: bytes) -> bool:
    """Check the sum of a sentence."""
    body, _, digits = frame.strip()[1:].rpartition(b"*")
    return b"%02X" % checksum(body) == digits.upper()


def _anything(frame: bytes) -> bool:  # noqa: ARG001 - the frames have a counter
    return True


ASK_FOR_NMEA = "read it with --protocol nmea; a damaged sentence may then look like a rate"
CONVERT = "a program of its maker can record it, and gyrodrift convert reads tables"


def _novatel(name: str, head: bytes, length: Callable[[bytes], int]) -> UnreadProtocol:
    """Logs of NovAtel, whose CRC-32 begins with 0."""
    return UnreadProtocol(
        name,
        re.compile(re.escape(head)),
        length,
        lambda frame: _crc32_from_0(frame[:-4]) == int.from_bytes(frame[-4:], "little"),
        CONVERT,
    )


def _mavlink(
    version: int, head: bytes, length: Callable[[bytes], int], chained: Callable[[bytes], int]
) -> UnreadProtocol:
    """MAVLink on a cable; the checksum depends on the message."""
    advice = "record its log (.bin, .ulg) or --out of mavlogdump.py, and give that to gyrodrift convert"
    name = f"MAVLink {version} of a flight controller"
    return UnreadProtocol(name, re.compile(head), length, _anything, advice, chained)


def _unchecked_nmea(about: str, sentence: bytes) -> UnreadProtocol:
    """Sentences without a checksum, which the user may ask for."""
    name = f"NMEA 0183 without checksums: {about}"
    return UnreadProtocol(
        name, re.compile(sentence), _line_length, _anything, ASK_FOR_NMEA, status="which does not show damage"
    )


UNREAD = (
    UnreadProtocol(
        "MicroStrain MIP (3DM-GX, 3DM-CX, 3DM-GQ)",
        re.compile(rb"\x75\x65"),
        lambda header: _byte(header, 3, 6),
        lambda frame: _fletcher(frame[:-2]) == frame[-2:],
        f"{CONVERT} of SensorConnect and of its ROS driver",
    ),
    UnreadProtocol(
        "the binary packets (snp) of a Redshift Labs UM6 or UM7",
        re.compile(rb"snp"),
        _snp_length,
        lambda frame: sum(frame[:-2]) & 0xFFFF == int.from_bytes(frame[-2:], "big"),
        "turn on its NMEA packets with rates ($PCHRS) instead, and read them with --columns",
    ),
    _mavlink(1, rb"\xfe", lambda header: _byte(header, 1, 8), lambda frame: frame[2]),
    _mavlink(
        2,
        rb"\xfd",
        lambda header: _byte(header, 1, 25 if header[2:3] == b"\x01" else 12),
        lambda frame: frame[4],
    ),
    UnreadProtocol(
        "rosserial",
        re.compile(rb"\xff[\xfe\xff]"),
        lambda header: _word(header, 2, 8),
        _is_rosserial,
        "let rosserial_python read the port, record its sensor_msgs/Imu with rosbag, and give the bag to gyrodrift",
    ),
    UnreadProtocol(
        "the teapot packets of InvenSense's and i2cdevlib's DMP examples",
        re.compile(rb"\$\x02"),
        lambda _: 14,
        lambda frame: frame[10] == 0 and frame[12:] == b"\r\n",
        "define OUTPUT_READABLE_YAWPITCHROLL in the sketch instead of OUTPUT_TEAPOT, or print the raw gyro",
        lambda frame: frame[11],
    ),
    UnreadProtocol(
        "Xsens MTData, the older output of an MTi",
        re.compile(rb"\xfa\xff\x32"),
        lambda header: _byte(header, 3, 5),
        lambda frame: sum(frame[1:]) & 0xFF == 0,
        "switch it to MTData2 with RateOfTurn (0x8020) and SampleTimeFine (0x1060), in MT Manager",
    ),
    UnreadProtocol(
        "UBX of a u-blox receiver",
        re.compile(rb"\xb5\x62"),
        lambda header: _word(header, 4, 8),
        lambda frame: _fletcher(frame[2:-2]) == frame[-2:],
        "it is a satellite receiver: turn on NMEA with $--HDT for its heading, or choose the port of the gyro",
    ),
    UnreadProtocol(
        "RTCM 3, corrections for satellite receivers",
        re.compile(rb"\xd3[\x00-\x03]"),
        lambda header: 6 + (int.from_bytes(header[1:3], "big") & 0x3FF),
        lambda frame: _crc24q(frame) == 0,
        "no gyro sends it: choose another port",
    ),
    _novatel("NovAtel binary logs", b"\xaa\x44\x12\x1c", lambda header: _word(header, 8, 32)),
    _novatel("NovAtel short binary logs", b"\xaa\x44\x13", lambda header: _byte(header, 3, 16)),
    UnreadProtocol(
        "the frames of a HiPNUC HI226, HI229 or CH100",
        re.compile(rb"\x5a\xa5"),
        lambda header: _word(header, 2, 6),
        lambda frame: crc_hqx(frame[:4] + frame[6:], 0) == int.from_bytes(frame[4:6], "little"),
        CONVERT,
    ),
    UnreadProtocol(
        "messages of a navX other than yaw, pitch and roll",
        re.compile(rb"![a-xz](?=[ -~]{6,200}\r\n)"),
        _line_length,
        _is_navx,
        "switch it to its yaw, pitch and roll messages (!y), with navXUI",
    ),
    UnreadProtocol(
        "yaw messages (!y) of a navX with wrong checksums",
        re.compile(rb"!y(?=(?:[-+][0-9]{3}\.[0-9]{2}){4}[0-9A-Fa-f]{2}\r\n)"),
        _line_length,
        lambda frame: not _is_navx(frame),
        "the line damages them, or the firmware is not original: check the cable, update the firmware",
    ),
    _unchecked_nmea(
        "$--ROT is the rate of turn in deg/min, positive to starboard",
        rb"\$(?=[A-Z]{2}ROT,[-+]?[0-9.]{1,12},[AV]\s)",
    ),
    _unchecked_nmea(
        "$--HDT, HDM, HDG and THS are headings in degrees, clockwise",
        rb"\$(?=[A-Z]{2}(?:HDT,[0-9.]{1,9},T|HDM,[0-9.]{1,9},M|THS,[0-9.]{1,9},A|HDG(?:,[0-9.EW]{0,9}){5})\s)",
    ),
    UnreadProtocol(
        "NMEA 0183 without a rate of turn ($--ROT) or a heading ($--HDT)",
        re.compile(rb"\$(?=[A-Z]{2}(?:GGA|GLL|GNS|GSA|GSV|RMC|VTG|ZDA|MWV|VHW|DBT|DPT),[ -~]{1,90}\*[0-9A-Fa-f]{2}\s)"),
        _line_length,
        _is_sentence,
        "turn on one of them, choose the port of the gyro, or name another sentence with --columns",
        status="which has no rate or heading",
    ),
)
