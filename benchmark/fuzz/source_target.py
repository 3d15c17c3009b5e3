"""Fuzz target for sources with their own messages: any content gives valid readings, MAVLink the same in any pieces."""

from collections.abc import Iterator
from math import isfinite, isinf, isnan, nan

from fuzz.packets import CAN_HEADER, packets_of
from gyrodrift.link.sources.can import BOSCH_IDS, XSENS_IDS, bosch, xsens
from gyrodrift.link.sources.can_frames import CanReadings
from gyrodrift.link.sources.iio_buffer import layout_of
from gyrodrift.link.sources.iio_readings import IDENTITY, IioChannel, IioDescription, IioReadings
from gyrodrift.link.sources.mavlink_decoder import ImuChoice, MavlinkDecoder
from gyrodrift.link.sources.rosbridge import ImuReadings, message_of
from gyrodrift.values.sample import Reading

CHUNK = 61
CHOICES = (ImuChoice(), ImuChoice(1, "raw_imu", 0.01, 0.01))
TYPES = {f"anglvel_{axis}": "le:s16/16>>0" for axis in "xyz"} | {"temp": "be:u12/16>>4", "timestamp": "le:s64/64>>0"}
SCALES = (0.001, 1e300, -1.0)


def source_decoders(content: bytes) -> None:
    """Messages of all sources."""
    for choice in CHOICES:
        whole, cut = MavlinkDecoder(choice), MavlinkDecoder(choice)
        at_once = whole.push(content)
        in_pieces = [
            reading for start in range(0, len(content), CHUNK) for reading in cut.push(content[start : start + CHUNK])
        ]
        assert repr(at_once) == repr(in_pieces)
        assert whole.counters == cut.counters
        assert all(map(is_valid, at_once))
    packets = list(packets_of(content))
    assert all(is_valid(reading) for reading in readings_of(packets) if reading is not None)


def readings_of(packets: list[bytes]) -> Iterator[Reading | None]:
    """Readings of packets as frames of a bus, as messages of ROS, and as scans."""
    gyros = (
        bosch("bosch-mm7.10", BOSCH_IDS, is_upside_down=True),
        xsens("xsens", XSENS_IDS, is_upside_down=False),
    )
    for gyro in gyros:
        bus = CanReadings(gyro)
        for packet in packets:
            if len(packet) >= CAN_HEADER.size:
                received_us, number = CAN_HEADER.unpack_from(packet)
                if number in gyro.ids:
                    yield bus.reading(received_us, number, packet[CAN_HEADER.size :])
    topic, layout = ImuReadings(), layout_of(TYPES)
    for packet in packets:
        message = message_of(packet)
        if message is not None:
            yield topic.reading(message)
    for scale in SCALES:
        chip = IioReadings(IioDescription("x", 1.0, IDENTITY, dict.fromkeys(TYPES, IioChannel(scale))))
        if layout is not None:
            yield from (chip.reading(layout.counts(packet), nan) for packet in packets if len(packet) == layout.size)


def is_valid(reading: Reading) -> bool:
    """Whether the numbers are finite or missing, and clock and counter are in range."""
    values = (reading.rate_dps, reading.encoder_deg, reading.temp_c, *(reading.inertial or ()))
    is_rate_same = reading.inertial is None or repr(reading.inertial.gyro_z_dps) == repr(reading.rate_dps)
    return (
        is_rate_same
        and all(isfinite(value) or isnan(value) for value in values)
        and not any(map(isinf, values))
        and (reading.t_us is None or 0 <= reading.t_us < 1 << 32)
        and (reading.seq is None or 0 <= reading.seq < 1 << 16)
    )
