"""Second sources on a link of their own: messages of any source become labeled values, and columns say what they are.

Text, JSON and NMEA sentences come as lines, ROS messages as JSON of rosbridge. MAVLink messages come as their fields,
CAN frames as the signals of a DBC file. Common messages need no columns.
"""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from math import isfinite, nan
from typing import Any

from gyrodrift.columns.aids import AidColumns
from gyrodrift.columns.fields import Form, Headings, as_label
from gyrodrift.columns.spec import AID_MEANINGS, Column, parsed
from gyrodrift.io.plain_text import decoded, plain_text
from gyrodrift.link.protocols.batch import ReadingBatch
from gyrodrift.values.aid import Aid

LONGEST_BYTES = 64 << 10
"""Longest line or message."""

DEEPEST = 8
"""Largest depth of nested objects that are read; an odometry of ROS has four."""

VALID = "A"
"""Status of a valid NMEA sentence (NMEA 0183)."""

Values = Mapping[str, str | float]
"""Values of a message by their labels, or by their positions from 0 on as text."""


@dataclass(frozen=True, slots=True)
class CommonMessage:
    """A message whose values need no columns.

    columns
        SPEC of its values.
    names
        Names of the sources by meaning; the meaning without an entry.
    valid
        Label of the status of a sentence that may be not valid; empty without one.
    missing
        Numbers that stand for a missing value, by label.
    is_command
        Whether it is a command to the motors, which says only whether the device stands.
    """

    columns: str
    names: Mapping[str, str] = field(default_factory=dict)
    valid: str = ""
    missing: Mapping[str, float] = field(default_factory=dict)
    is_command: bool = False


COURSE = {"heading": "course"}
MESSAGES: Mapping[str, CommonMessage] = {
    "RMC": CommonMessage("RMC 7=speed:kn, RMC 8=heading:compass", COURSE, "RMC 2"),
    "VTG": CommonMessage("VTG 5=speed:kn, VTG 1=heading:compass", COURSE),
    "HDT": CommonMessage("HDT 1=heading:compass"),
    "HDM": CommonMessage("HDM 1=heading:compass"),
    "HDG": CommonMessage("HDG 1=heading:compass"),
    "THS": CommonMessage("THS 1=heading:compass", valid="THS 2"),
    "GPS_RAW_INT": CommonMessage(
        "GPS_RAW_INT.vel=speed:mps:lsb/100, GPS_RAW_INT.cog=heading:compass:lsb/100",
        COURSE,
        missing={"GPS_RAW_INT.vel": 65535.0, "GPS_RAW_INT.cog": 65535.0},
    ),
    "WHEEL_DISTANCE": CommonMessage("WHEEL_DISTANCE.left=wheel_left, WHEEL_DISTANCE.right=wheel_right"),
    "twist.twist.linear.x": CommonMessage("twist.twist.linear.x=speed, twist.twist.angular.z=turn_rate:rads"),
    "linear.x": CommonMessage("linear.x=speed, angular.z=turn_rate:rads", is_command=True),
}
"""Messages by the last letters of an NMEA sentence, the name of a MAVLink message, or a label of a ROS message:
RMC and VTG have the course over ground, HDT, HDM, HDG and THS a heading (NMEA 0183); GPS_RAW_INT has cm/s and 0.01 deg
(MAVLink common); nav_msgs/Odometry has the twist of the base, and geometry_msgs/Twist is a command (ROS)."""


class SecondSource:
    """Measurements in the messages of a source.

    Parameters
    ----------
    name
        Name of the source, before the names of its measurements.
    columns
        SPEC of its values; None for common messages.
    late_s
        Delay of its messages, s.
    is_mavlink
        Whether its bytes are MAVLink.
    """

    def __init__(self, name: str, columns: str | None = None, late_s: float = 0.0, *, is_mavlink: bool = False) -> None:
        self.understood = self.messages = 0
        self._name, self._late_s = name, late_s
        self._own = None if columns is None else _Reader(name, parsed(columns, is_aid=True))
        self._readers: dict[str, _Reader | None] = {}
        self._values_of = MavlinkValues().of if is_mavlink else LineValues().of

    def take(self, chunk: bytes | ReadingBatch) -> list[Aid]:
        """Measurements of the next bytes or messages; their times, if any, count from now."""
        aids: list[Aid] = []
        content = b"".join(b"%b\n" % it for it in chunk.messages) if isinstance(chunk, ReadingBatch) else chunk
        for kind, values in self._values_of(content):
            self.messages += 1
            reader = self._own or self._reader(kind, values)
            of_message = () if reader is None else reader.aids_of(values)
            self.understood += bool(of_message)
            aids += of_message
        return [self._delayed(aid) for aid in aids] if self._late_s else aids

    def _delayed(self, aid: Aid) -> Aid:
        return aid._replace(t_s=(aid.t_s if isfinite(aid.t_s) else 0.0) - self._late_s)

    def _reader(self, kind: str, values: Values) -> "_Reader | None":
        """Reader of a common message; None for another one."""
        key = kind or next((label for label in MESSAGES if label in values), "")
        if key not in MESSAGES:
            return None
        if key not in self._readers:
            common = MESSAGES[key]
            self._readers[key] = _Reader(self._name, parsed(common.columns, is_aid=True), common)
        return self._readers[key]


class _Reader:
    """Reads the values of a message by columns."""

    def __init__(self, name: str, columns: Sequence[Column], common: CommonMessage | None = None) -> None:
        self._columns = [
            (as_label(column.label) or str(index), column)
            for index, column in enumerate(columns)
            if column.meaning in AID_MEANINGS or column.meaning == "still"
        ]
        self._aids = AidColumns(columns, f"{name}.", None if common is None else common.names)
        common = common or CommonMessage("")
        self._valid, self._missing, self._is_command = common.valid, common.missing, common.is_command
        self._name = name

    def aids_of(self, values: Values) -> tuple[Aid, ...]:
        """Measurements of a message; none if it is not valid."""
        if self._valid and values.get(self._valid) != VALID:
            return ()
        numbers = {
            column.meaning: number * column.scale
            for label, column in self._columns
            if isfinite(number := _number(values.get(label, nan))) and number != self._missing.get(label)
        }
        if self._is_command:
            return (Aid(f"{self._name}.command", "standing", float(not any(numbers.values()))),) if numbers else ()
        aids = self._aids.aids_of(numbers)
        return (*aids, Aid(f"{self._name}.standing", "standing", numbers["still"])) if "still" in numbers else aids


def _number(value: str | float) -> float:
    try:
        return float(value)
    except (ValueError, OverflowError):
        return nan


class LineValues:
    """Values of lines: JSON objects, NMEA sentences, labels, or rows of values."""

    def __init__(self) -> None:
        self._pending = b""
        self._headings = Headings()

    def of(self, chunk: bytes) -> Iterator[tuple[str, Values]]:
        """Kind and values of each complete line; the kind is that of an NMEA sentence, else empty."""
        *lines, pending = (self._pending + chunk.replace(b"\r", b"\n")).split(b"\n")
        self._pending = pending[-LONGEST_BYTES:]
        for line in lines:
            if text := decoded(plain_text(line).strip()):
                yield from self._values(text)

    def _values(self, text: str) -> Iterator[tuple[str, Values]]:
        if text.startswith("{"):
            try:
                content = json.loads(text)
            except (ValueError, RecursionError):
                return
            message = content.get("msg", content) if isinstance(content, dict) else {}
            yield "", dict(_leaves(message))
        elif (fields := self._headings.fields_of(text)) is not None:
            if fields.form is Form.NMEA:
                kind = fields.values[0][-3:]
                yield kind, {f"{kind} {index}": value for index, value in enumerate(fields.values)}
            else:
                by_position = {str(index): value for index, value in enumerate(fields.values)}
                yield "", by_position | dict(zip(fields.labels, fields.values, strict=True))


def _leaves(content: Any, path: str = "", deepest: int = DEEPEST) -> Iterator[tuple[str, str | float]]:
    """Numbers and texts of an object by their path, with points."""
    if isinstance(content, dict) and deepest:
        for key, value in content.items():
            yield from _leaves(value, f"{path}.{as_label(key)}" if path else as_label(key), deepest - 1)
    elif isinstance(content, (int, float, str)):
        yield path, float(content) if isinstance(content, bool) else content


class MavlinkValues:
    """Values of MAVLink messages, labeled `MESSAGE.field`; distances of wheels become their speeds."""

    def __init__(self) -> None:
        from pymavlink.dialects.v20 import ardupilotmega

        self._parser = ardupilotmega.MAVLink(None)
        self._parser.robust_parsing = True
        self._wheels: tuple[float, float, float] | None = None

    def of(self, chunk: bytes) -> Iterator[tuple[str, Values]]:
        """Name and values of each whole message."""
        for message in self._parser.parse_buffer(chunk) or ():
            name = message.get_type()
            values = {f"{name}.{key}": value for key, value in message.to_dict().items()}
            yield name, self._wheel_speeds(message) if name == "WHEEL_DISTANCE" else values
        del self._parser.buf[: self._parser.buf_index]
        self._parser.buf_index = 0

    def _wheel_speeds(self, message: Any) -> Values:
        """Speeds of the first two wheels since the last message, m/s."""
        before, self._wheels = self._wheels, (message.time_usec * 1e-6, *message.distance[:2])
        seconds = 0.0 if before is None else self._wheels[0] - before[0]
        if before is None or message.count < 2 or seconds <= 0.0:
            return {}
        speeds = [(now - then) / seconds for now, then in zip(self._wheels[1:], before[1:], strict=True)]
        return dict(zip(("WHEEL_DISTANCE.left", "WHEEL_DISTANCE.right"), speeds, strict=True))
