"""Known protocols that are not read, with advice, so that the baud rate is not blamed.

One record per protocol. A stream belongs to it if it has FRAMES_MIN frames with a right checksum.
"""

import re
import shlex
import zlib
from binascii import crc_hqx
from collections.abc import Callable
from dataclasses import dataclass
from functools import reduce
from itertools import accumulate
from operator import xor

from gyrodrift.link.binary_frames import crc16_reflected, crc32_mpeg2
from gyrodrift.link.protocols.sentences import checksum

LINE = "LINE"
"""Stands in an advice for the port and its baud rate."""

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

    def message(self, line: str) -> str:
        """Name and advice; `line` is the port and its baud rate, as in a command: `/dev/ttyUSB0,57600`."""
        return f"the device sends {self.name}, {self.status}; {self.advice.replace(LINE, shlex.quote(line))}"

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
FLIGHT_CONTROLLER = "let it send MAVLink and use --port mavlink:LINE, or convert its blackbox log"
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
    name, status = f"MAVLink {version} of a flight controller", "which gyrodrift reads as a source"
    return UnreadProtocol(name, re.compile(head), length, _anything, f"use --port mavlink:{LINE}", chained, status)


def _is_lpbus(frame: bytes) -> bool:
    """Check the sum of all bytes between the head and itself."""
    return frame[-2:] == b"\r\n" and sum(frame[1:-4]) & 0xFFFF == int.from_bytes(frame[-4:-2], "little")


def _anpp_length(header: bytes) -> int:
    """Length of a packet whose header has a right checksum (Advanced Navigation Packet Protocol)."""
    if len(header) < 5 or header[0] != (sum(header[1:5]) ^ 0xFF) + 1 & 0xFF:
        return 0
    return 5 + header[2]


def _is_anpp(frame: bytes) -> bool:
    """Check the CRC of the data; without data nothing is checked."""
    return len(frame) > 5 and crc_hqx(frame[5:], 0xFFFF) == int.from_bytes(frame[3:5], "little")


def _msp2_crc(content: bytes) -> int:
    """CRC-8 of DVB-S2."""
    crc = 0
    for byte in content:
        crc ^= byte
        for _ in range(8):
            crc = (crc << 1 ^ (0xD5 if crc & 0x80 else 0)) & 0xFF
    return crc


def _shtp_length(header: bytes) -> int:
    """Length up to the closing flag of a frame."""
    return header.find(b"\x7e", 1) + 1


def _is_shtp(frame: bytes) -> bool:
    """Compare the length in the header of SHTP with that of the frame, without its escapes."""
    cargo = re.sub(rb"\x7d(.)", lambda match: bytes((match[1][0] ^ 0x20,)), frame[2:-1], flags=re.DOTALL)
    return len(cargo) >= 4 and int.from_bytes(cargo[:2], "little") & 0x7FFF == len(cargo)


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
        "the messages of a KVH 1725, 1750 or 1775",
        re.compile(rb"\xfe\x81\xff[\x55-\x57]"),
        lambda header: {0x55: 36, 0x56: 40, 0x57: 38}[header[3]] if len(header) > 3 else 0,
        lambda frame: crc32_mpeg2(frame[:-4]) == int.from_bytes(frame[-4:], "big"),
        CONVERT,
    ),
    UnreadProtocol(
        "sbgECom of an SBG Ellipse, Ekinox or Quanta",
        re.compile(rb"\xff\x5a"),
        lambda header: _word(header, 4, 9),
        lambda frame: crc16_reflected(frame[2:-3], 0, 0x8408) == int.from_bytes(frame[-3:-1], "little"),
        CONVERT,
    ),
    UnreadProtocol(
        "LpBus of an LPMS (LP-Research)",
        re.compile(rb"\x3a"),
        lambda header: _word(header, 5, 11),
        _is_lpbus,
        CONVERT,
    ),
    UnreadProtocol(
        "the UU packets of an Aceinna OpenIMU or DMU",
        re.compile(rb"UU[A-Za-z][A-Za-z0-9]"),
        lambda header: _byte(header, 4, 7),
        lambda frame: crc_hqx(frame[2:-2], 0x1D0F) == int.from_bytes(frame[-2:], "big"),
        CONVERT,
    ),
    UnreadProtocol(
        "MSP of Betaflight, Cleanflight or iNav",
        re.compile(rb"\$M[<>!]"),
        lambda header: _byte(header, 3, 6),
        lambda frame: reduce(xor, frame[3:-1]) == frame[-1],
        FLIGHT_CONTROLLER,
    ),
    UnreadProtocol(
        "MSP 2 of Betaflight or iNav",
        re.compile(rb"\$X[<>!]"),
        lambda header: _word(header, 6, 9),
        lambda frame: _msp2_crc(frame[3:-1]) == frame[-1],
        FLIGHT_CONTROLLER,
    ),
    UnreadProtocol(
        "RAWIMU of a NovAtel receiver, which has angles per sample in counts of its sensor, not rates",
        re.compile(rb"[#%]RAWIMUS?X?A,(?=[ -~]{40,400}\*[0-9a-f]{8}\r?\n)"),
        _line_length,
        _anything,
        "log INSPVAS for its azimuth, or let its program convert the counts, and give the table to gyrodrift convert",
    ),
    UnreadProtocol(
        "SHTP of a BNO080, BNO085 or BNO086",
        re.compile(rb"\x7e\x01"),
        _shtp_length,
        _is_shtp,
        "set its pins PS1 low and PS0 high: then it sends bno08x-rvc, which gyrodrift reads",
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
    UnreadProtocol(
        "ANPP of Advanced Navigation",
        re.compile(rb"[\x00-\xff]"),
        _anpp_length,
        _is_anpp,
        CONVERT,
    ),
)
