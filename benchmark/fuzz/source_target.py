"""Fuzz target for sources with their own packets: any bytes, in one piece and in many, give the same valid readings."""

from collections.abc import Callable
from math import isfinite, isinf, isnan

from gyrodrift.link.protocols.decoder import Decoder
from gyrodrift.link.sources.can_frames import CanDecoder
from gyrodrift.link.sources.can_gyros import BOSCH_IDS, XSENS_IDS, bosch, xsens
from gyrodrift.link.sources.iio_scans import IioDecoder
from gyrodrift.link.sources.mavlink_frames import ImuChoice, MavlinkDecoder
from gyrodrift.link.sources.ros_imu import RosImuDecoder
from gyrodrift.values.sample import Reading

CHUNK = 61

DECODERS: dict[str, Callable[[], Decoder]] = {
    "mavlink": lambda: MavlinkDecoder(ImuChoice()),
    "mavlink of one message": lambda: MavlinkDecoder(ImuChoice(1, "raw_imu", 0.01, 0.01)),
    "iio": IioDecoder,
    "rosbridge": RosImuDecoder,
    "bosch": lambda: CanDecoder(bosch("bosch-mm7.10", BOSCH_IDS, is_upside_down=True)),
    "xsens": lambda: CanDecoder(xsens("xsens", XSENS_IDS, is_upside_down=False)),
}


def source_decoders(content: bytes) -> None:
    """Packets of all sources."""
    for make in DECODERS.values():
        whole, cut = make(), make()
        at_once = whole.push(content)
        in_pieces = [
            reading for start in range(0, len(content), CHUNK) for reading in cut.push(content[start : start + CHUNK])
        ]
        assert repr(at_once) == repr(in_pieces)
        assert whole.counters == cut.counters
        assert all(map(is_valid, at_once))


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
