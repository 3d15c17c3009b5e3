"""Frames worked out from the protocol's text; the device has to write them and the host to read them.

The CRCs are those of the `crc` package from PyPI (Crc16.IBM_3740, another name of CCITT-FALSE); stuffing and sums
were done with a few lines written for this table alone.
"""

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

WT901_RATES = {
    (-1000, 2512): bytes.fromhex("55520000000018fcd00994"),
    (32767, -100): bytes.fromhex("555200000000ff7f9cffc0"),
}
"""Frames of kind 0x52 by yaw rate in counts and temperature in hundredths of °C."""

WT901_ACCELERATION = bytes.fromhex("5551000000000008c4097b")
"""Kind 0x51 of a level device at 25 °C."""
