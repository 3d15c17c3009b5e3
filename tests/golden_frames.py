"""Frames worked out from the protocol's text; the device has to write them and the host to read them.

The CRCs are those of the `crc` package from PyPI (Crc16.IBM_3740, another name of CCITT-FALSE); stuffing and sums
were done with a few lines written for this table alone.
"""

from math import nan
from typing import NamedTuple


class NativeSample(NamedTuple):
    flags: int
    seq: int
    t_us: int
    rate_raw: int
    temp_centi_c: int
    encoder_counts: int


HELLO = bytes.fromhex("04010164071405fa3ba08c010d6669726d776172655f73696d010101021a0100")
"""100 Hz, 0.00763 deg/s per count, 36000 counts per turn, device `firmware_sim`."""

SAMPLES = {
    NativeSample(3, 0, 0, 0, 2500, 0): bytes.fromhex("0302030101010101010103c40901010103abd900"),
    NativeSample(3, 65535, 4294967295, -32767, -1050, -1): bytes.fromhex("130203ffffffffffff0180e6fbffffffff79a500"),
    NativeSample(7, 258, 16909060, 32767, 2500, 123456): bytes.fromhex("100207020104030201ff7fc40940e2010304b800"),
    NativeSample(0, 1, 10000, -1, 0, 0): bytes.fromhex("020202010310270103ffff010101010103abd400"),
}


class NativeSample3(NamedTuple):
    flags: int
    seq: int
    t_us: int
    gyro_raw: tuple[int, int, int]
    accel_raw: tuple[int, int, int]
    temp_centi_c: int
    encoder_counts: int


AXES_HELLO = bytes.fromhex("04010264071405fa3ba08c010d6669726d776172655f73696d0101010803e89c3b03699300")
"""HELLO version 2 of the same device with three axes, 0.0047884 m/s² per count."""

NO_ACCELEROMETER_HELLO = bytes.fromhex("04010264051405fa3b0101010d6669726d776172655f73696d010101010101010403e21700")
"""Three axes without accelerometer and encoder."""

AXES_SAMPLES = {
    NativeSample3(0x13, 0, 0, (0, 0, 0), (0, 0, 2048), 2500, 0): bytes.fromhex(
        "030313010101010101010101010101010101010408c40901010103948200"
    ),
    NativeSample3(0x57, 65535, 4294967295, (-32767, 1, 32767), (-32767, 0, -1), -1050, -1): bytes.fromhex(
        "0c0357ffffffffffff01800105ff7f0180010bffffe6fbffffffff3aad00"
    ),
    NativeSample3(0x28, 258, 16909060, (-1, 2, -3), (4, -5, 6), 0, 123456): bytes.fromhex(
        "0c0328020104030201ffff0204fdff0404fbff0601010440e201032d9100"
    ),
}
"""SAMPLE3: level at 1 g; clipped in every respect; at rest, without acceleration and encoder."""

FILTER_HELLO = bytes.fromhex("04010364071405fa3ba08c010d6669726d776172655f73696d010101010101010501021e5a00")
"""HELLO version 3 of the same device with one axis, which runs restlevel."""

AXES_FILTER_HELLO = bytes.fromhex("04010364071405fa3ba08c010d6669726d776172655f73696d0101010903e89c3b0303656700")
"""HELLO version 3 with three axes, which runs attitude."""


class NativeYaw(NamedTuple):
    seq: int
    t_us: int
    yaw_deg: float
    yaw_sigma_deg: float
    bias_dps: float


YAWS = {
    NativeYaw(0, 0, 0.0, 0.0, 0.0): bytes.fromhex("020401010101010101010101010101010101010103742000"),
    NativeYaw(258, 16909060, -1234.5, nan, 0.25): bytes.fromhex("02040702010403020104509ac40103c07f0105803ec69300"),
    NativeYaw(65535, 4294967295, 90.5, 0.125, -0.0078125): bytes.fromhex(
        "020407ffffffffffff0103b5420101023e010104bccf1100"
    ),
}

WT901_RATES = {
    (-1000, 2512): bytes.fromhex("55520000000018fcd00994"),
    (32767, -100): bytes.fromhex("555200000000ff7f9cffc0"),
}
"""Frames of kind 0x52 by yaw rate in counts and temperature in hundredths of °C."""

WT901_ACCELERATION = bytes.fromhex("5551000000000008c4097b")
"""Kind 0x51 of a level device at 25 °C."""

VECTORNAV_ANGLES = bytes.fromhex("fa01080093502e42833ef13f48b504bb9288")
"""Yaw, pitch and roll alone, 43.579, 1.885 and -0.002 deg: an example of the user manual of the VN-100."""

VECTORNAV_RATE = bytes.fromhex("fa012104") + bytes.fromhex(
    "40420f00000000000000803e000000bf0000003f0000000000000000000000000000ca4166a6ca428e88"
)
"""TimeStartup 1 ms, rates 0.25, -0.5 and 0.5 rad/s, 25.25 °C; its CRC is that of `binascii`."""

VECTORNAV_VNYMR = (
    b"$VNYMR,+100.949,-007.330,+000.715,-00.0049,-00.2449,+00.5397,-01.258,-00.100,-09.701,"
    b"-00.000018,+00.001122,-00.000551*69\r\n"
)
"""From the maker's examples: z -0.000551 rad/s."""

VECTORNAV_VNIMU = (
    b"$VNIMU,-00.0350,+00.4222,-00.6643,-00.015,+00.019,+09.948,+00.002066,-00.008442,-00.044656,+20.7,+084.322*66\r\n"
)
"""Frame of a VN-200: z -0.044656 rad/s, 20.7 °C."""

XSENS_MTI300 = bytes.fromhex(
    "faff3692"
    "102002918d 10600401363fa6 2010103f35e0423f31cd15bd9f49dbbda938cf 40200cbd635a90411d08d43e5faa50"
    "40100cb91168003cc901003a0f7d00 40300cbc3b29803c35fc003ca46e00 80200c3caea241bb56d800bad5ac01"
    "8030103f80000037df8801b6898000b608c000 c0200cbefbfbf23f33c485bfa0a2c1 08100442168000"
    "301004000186e1 e0200400400003"
)
"""Recorded of an MTi-300 with the maker's MT Manager, all but its sum: packet 37261, ticks 20332454, rate about z
-0.00163019 rad/s, 37.625 °C."""

RVC_FRAME = bytes.fromhex("aaaade010092ff25088dfeecffd103000000e7")
"""The example of the data sheet of the BNO08x: index 222, yaw 0.01, pitch -1.10, roll 20.85 deg, -371, -20, 977 mg."""

NMEA_ROT = b"$GPROT,35.6,A*01\r\n"
"""The example of gpsd's description of NMEA: 35.6 deg/min to starboard."""
