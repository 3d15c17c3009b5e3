"""CAN gyros with a public description.

bosch-mm5.10, bosch-mm7.10
    Bosch Motorsport acceleration sensors: three frames with a rate and an acceleration each, little-endian (calibration
    sheet MM5.10; data sheet MM7.10). Scales of the ABS M5 Kit manual, chapter 13: 0.005 deg/s and 0.000127465 g, of
    counts from 0 to 65535 around 0x8000. The MM5.10 has no pitch rate.
xsens
    Xsens MTi 600, Avior and Sirius: frames with time, counter, rates and accelerations, big-endian (MT CAN Protocol
    Documentation, MT1604P; https://mtidocs.movella.com/canmessages).
"""

from collections.abc import Mapping
from math import degrees
from struct import Struct

from gyrodrift.link.sources.can_frames import CanGyro
from gyrodrift.values.constants import STANDARD_GRAVITY_MPS2

BOSCH_IDS = (0x174, 0x178, 0x17C)
BOSCH_FRAME = Struct("<HxxH")
BOSCH_ZERO = 0x8000
BOSCH_DPS = 0.005
BOSCH_MPS2 = 0.000127465 * STANDARD_GRAVITY_MPS2
BOSCH_FIELDS = (("gz", "ay"), ("gx", "ax"), ("gy", "az"))
"""Rate and acceleration of the three frames."""

XSENS_TIME, XSENS_COUNTER = 0x005, 0x006
XSENS_RATES, XSENS_RATES_HR, XSENS_FORCES, XSENS_FORCES_HR = 0x032, 0x040, 0x034, 0x041
XSENS_IDS = (XSENS_TIME, XSENS_COUNTER, XSENS_RATES, XSENS_FORCES, XSENS_RATES_HR, XSENS_FORCES_HR)
XSENS_TICK_US = 100
XSENS_DPS = degrees(2.0**-9)
XSENS_MPS2 = 2.0**-8
TICKS, COUNT, VECTOR = Struct(">I"), Struct(">H"), Struct(">3h")

RATE_NAMES, FORCE_NAMES = ("gx", "gy", "gz"), ("ax", "ay", "az")


def bosch(name: str, ids: tuple[int, ...], *, is_upside_down: bool) -> CanGyro:
    """Gyro of Bosch with the ids of its frames in the order of the data sheet."""
    has_pitch = name != "bosch-mm5.10"
    kinds = dict(zip(ids, BOSCH_FIELDS, strict=True))

    def fields(number: int, content: bytes) -> Mapping[str, float]:
        """Rate and acceleration of a frame."""
        if len(content) < BOSCH_FRAME.size:
            return {}
        rate, force = BOSCH_FRAME.unpack_from(content)
        rate_name, force_name = kinds[number]
        values = {force_name: (force - BOSCH_ZERO) * BOSCH_MPS2}
        if has_pitch or rate_name != "gy":
            values[rate_name] = (rate - BOSCH_ZERO) * BOSCH_DPS
        return values

    return CanGyro(name, frozenset(ids), fields, is_upside_down)


def xsens(name: str, ids: tuple[int, ...], *, is_upside_down: bool) -> CanGyro:
    """Gyro of Xsens; its frames have fixed ids unless its configuration changes them."""
    kinds = dict(zip(ids, XSENS_IDS, strict=True))

    def fields(number: int, content: bytes) -> Mapping[str, float]:
        """Values of a frame."""
        kind = kinds[number]
        if kind == XSENS_TIME and len(content) == TICKS.size:
            return {"t_us": TICKS.unpack(content)[0] * XSENS_TICK_US}
        if kind == XSENS_COUNTER and len(content) == COUNT.size:
            return {"seq": COUNT.unpack(content)[0]}
        if len(content) != VECTOR.size or kind in (XSENS_TIME, XSENS_COUNTER):
            return {}
        is_rate = kind in (XSENS_RATES, XSENS_RATES_HR)
        names, scale = (RATE_NAMES, XSENS_DPS) if is_rate else (FORCE_NAMES, XSENS_MPS2)
        return {name: value * scale for name, value in zip(names, VECTOR.unpack(content), strict=True)}

    return CanGyro(name, frozenset(ids), fields, is_upside_down)


CAN_GYROS = {
    "bosch-mm5.10": (bosch, BOSCH_IDS),
    "bosch-mm7.10": (bosch, BOSCH_IDS),
    "xsens": (xsens, XSENS_IDS),
}
"""Gyros by name, with their usual ids."""
