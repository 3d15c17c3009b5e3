"""Changes of streams of frames: frames with a right checksum whose content is any, and frames lost, doubled or cut."""

import struct
from collections.abc import Callable
from random import Random

from firmware_sim.wire.bno08x_rvc import rvc_frame
from firmware_sim.wire.native import (
    HELLO_TYPE,
    SAMPLE_TYPE,
    axes_sample_frame,
    native_frame,
    sample_frame,
    yaw_frame,
)
from firmware_sim.wire.navx import yaw_message
from firmware_sim.wire.nmea import sentence
from firmware_sim.wire.vectornav import vectornav_frame
from firmware_sim.wire.witmotion import wt901_frame
from firmware_sim.wire.witmotion_ble import ble_frame
from firmware_sim.wire.xsens import item, mtdata2

READING = struct.Struct("<IHfBf")
"""Of the target `clocks`: time, counter, rate, ms since the reading before, and a number that is not used."""

HELLO = struct.Struct("<BBHfI16s")
AXES_HELLO = struct.Struct("<BBHfI16sfB")
FILTER_HELLO = struct.Struct("<BBHfI16sfBB")
YAWS = (0.0, -0.0, 90.0, -1e7, 1e30, float("inf"), float("nan"))
WORDS_16 = (0, 1, -1, 0x7FFF, -0x8000)
RATES = (0.0, -0.0, 1e-9, 0.00763, 10.0, 10.000001, 1e38, float("inf"), float("nan"), -1.0)


def changed_frames(content: bytes, random: Random) -> bytes:
    """One to some whole frames of one protocol put into the stream."""
    kinds = (_sample, _sample, _sample3, _hello, _axes_hello, _native, _with_yaw, _filter_hello)
    make = random.choice((*kinds, _wt901, _xsens, _vectornav, _sentence, _rvc, _ble, _navx))
    made = b"".join(make(random) for _ in range(random.choice((1, 2, 3, 12))))
    at = random.randint(0, len(content))
    return content[:at] + made + content[at:]


def _word(random: Random) -> int:
    return random.choice((random.choice(WORDS_16), random.randint(-0x8000, 0x7FFF)))


def _sample(random: Random) -> bytes:
    seq, t_us = (
        random.choice((0, 1, 65535, random.getrandbits(16))),
        random.choice((0, 1 << 31, random.getrandbits(32))),
    )
    flags = random.choice((0x03, 0x1B, random.randrange(256)))
    return sample_frame(flags, seq, t_us, _word(random), _word(random), random.randint(-(1 << 31), (1 << 31) - 1))


def _hello(random: Random) -> bytes:
    scale = random.choice(RATES)
    name = random.choice((b"firmware_sim", b"\x1b[2J\x07", b"\xff" * 16, b"", random.randbytes(16)))
    version, hz = random.choice((1, 1, 1, 0, 2)), random.choice((0, 1, 100, 1000, 65535))
    return native_frame(HELLO.pack(HELLO_TYPE, version, hz, scale, random.choice((0, 1, 2400, (1 << 32) - 1)), name))


def _sample3(random: Random) -> bytes:
    raw = [random.randint(-32768, 32767) for _ in range(6)]
    flags, seq, t_us, counts = (random.getrandbits(bits) for bits in (8, 16, 32, 32))
    return axes_sample_frame(flags, seq, t_us, raw[:3], raw[3:], random.randint(-32768, 32767), counts)


def _with_yaw(random: Random) -> bytes:
    """A sample, and a YAW that may be that of another one, or come twice."""
    seq, t_us = random.choice((0, 1, 65535, random.getrandbits(16))), random.getrandbits(32)
    values = [random.choice(YAWS) for _ in range(3)]
    own = yaw_frame(seq + random.choice((0, 0, 0, 1)), t_us + random.choice((0, 0, 0, 1)), *values)
    return sample_frame(0x03, seq, t_us, _word(random), 0, 0) + own * random.choice((0, 1, 1, 2))


def _filter_hello(random: Random) -> bytes:
    version, axes, number = random.choice((3, 3, 3, 2, 4)), random.choice((1, 3, 0)), random.choice((0, 1, 2, 3, 255))
    fields = (HELLO_TYPE, version, 100, 0.00763, 36000, b"bench", random.choice(RATES), axes, number)
    return native_frame(FILTER_HELLO.pack(*fields))


def _axes_hello(random: Random) -> bytes:
    scale, axes = random.choice((0.0, 0.0048, 1e9, float("nan"))), random.choice((0, 1, 3))
    version = random.choice((1, 2, 2, 2))
    return native_frame(AXES_HELLO.pack(HELLO_TYPE, version, 100, 0.00763, 36000, b"bench", scale, axes))


def _native(random: Random) -> bytes:
    """A right checksum around any bytes, of any kind and length."""
    kind = random.choice((HELLO_TYPE, SAMPLE_TYPE, random.randrange(256)))
    return native_frame(bytes((kind,)) + random.randbytes(random.choice((0, 1, 15, 27, 28, 60))))


def _wt901(random: Random) -> bytes:
    kind = random.choice((0x52, 0x52, 0x51, random.randrange(256)))
    return wt901_frame(kind, *(_word(random) for _ in range(4)))


def _xsens(random: Random) -> bytes:
    kinds = (0x8020, 0x8021, 0x8022, 0x8023, 0x8040, 0x1020, 0x1060, 0x0810, 0x2030, 0x2037, 0x2010)
    items = (item(random.choice(kinds), random.randbytes(random.choice((2, 4, 12, 18, 24)))) for _ in range(3))
    return mtdata2(b"".join(items))


def _vectornav(random: Random) -> bytes:
    return vectornav_frame(random.getrandbits(15), random.randbytes(random.choice((12, 20, 40, 160))))


def _sentence(random: Random) -> bytes:
    rate = random.choice(("12.0", "-0", "1e999", "nan", "", "9" * 60))
    rates = (f"HEROT,{rate},A", f"TIROT,{rate},V", f"VNYMR,{rate}" + ",1" * 11, f"VNIMU{',1' * 9}")
    angles = (f"HEHDT,{rate},T", f"HCHDG,{rate},,,,", f"VNYPR,{rate},0,0", f"VNQTN,0,0,{rate},{rate}")
    return sentence(random.choice((*rates, *angles)))


def _rvc(random: Random) -> bytes:
    return rvc_frame(random.randrange(256), *(_word(random) for _ in range(6)))


def _ble(random: Random) -> bytes:
    """Several of them: fewer are not believed."""
    return b"".join(ble_frame(random.choice((0.0, 2000.0, random.gauss(0.0, 50.0)))) for _ in range(5))


def _navx(random: Random) -> bytes:
    return b"".join(yaw_message(random.choice((0.0, 179.99, random.uniform(-180.0, 180.0)))) for _ in range(3))


def changed_readings(content: bytes, random: Random) -> bytes:
    """Readings of a clock and a counter, some of them steps, wraps, repetitions or a new beginning."""
    count = len(content) // READING.size
    readings = [READING.unpack_from(content, index * READING.size) for index in range(count)]
    at = random.randint(0, count)
    before = readings[at - 1] if at else (0, 0, 0.0, 10, 0.0)
    made, step_us = [], random.choice((100, 1000, 10_000, 1_000_000))
    change = random.choice(CHANGES)
    for index in range(random.choice((1, 5, 60, 400))):
        t_us, seq = before[0] + (index + 1) * step_us, before[1] + index + 1
        made.append(change(t_us, seq, random) if index % 7 == 3 else (t_us, seq))
    rate_dps = random.choice((0.0, 1.0, random.gauss(0.0, 0.1), 1e20, float("nan")))
    late_ms = random.choice((0, step_us // 1000 & 0xFF, 255))
    new = [(t_us & 0xFFFFFFFF, seq & 0xFFFF, rate_dps, late_ms, 0.0) for t_us, seq in made]
    return b"".join(READING.pack(*each) for each in [*readings[:at], *new, *readings[at:]])


Change = Callable[[int, int, Random], tuple[int, int]]
CHANGES: tuple[Change, ...] = (
    lambda t_us, seq, _: (t_us, seq),
    lambda t_us, seq, random: (t_us + random.choice((-1, 1)) * random.getrandbits(random.choice((8, 20, 32))), seq),
    lambda t_us, seq, random: (t_us, seq + random.getrandbits(random.choice((3, 15, 16)))),
    lambda _t_us, _seq, random: (random.getrandbits(32), random.getrandbits(16)),
    lambda _t_us, _seq, _random: (0, 0),
)
