"""The C header of the native protocol, on this machine: golden frames, any fields, any damage, strict compilers."""

import ctypes
import shutil
from collections.abc import Callable
from itertools import islice
from pathlib import Path

import numpy as np
import pytest
from firmware_support import HEADERS, STRICT, UNO, compiled, run
from golden_frames import (
    AXES_FILTER_HELLO,
    AXES_HELLO,
    AXES_SAMPLES,
    FILTER_HELLO,
    HELLO,
    SAMPLES,
    YAWS,
    NativeSample,
    NativeSample3,
    NativeYaw,
)
from hypothesis import given
from hypothesis import strategies as st

from firmware_sim.measure import measure
from firmware_sim.motion.profile import load_profile
from firmware_sim.rig import Base, Rig, load_rig
from firmware_sim.wire import native
from firmware_sim.wire.native import axes_sample_frame, sample_frame, yaw_frame
from gyrodrift.link.protocols.native import DPS_PER_LSB_MAX, DPS_PER_LSB_MIN, NativeDecoder

i16 = st.integers(-(2**15), 2**15 - 1)
i32 = st.integers(-(2**31), 2**31 - 1)
SCALES = (float(np.nextafter(np.float32(DPS_PER_LSB_MIN), np.float32(1.0))), DPS_PER_LSB_MAX)
"""Limits of a count that a decoder believes; a float of four bytes."""

f32 = st.floats(width=32)
u16 = st.integers(0, 2**16 - 1)
u32 = st.integers(0, 2**32 - 1)
AXES_HELLO_MPS2 = 0.0047884
"""Scale of the golden HELLO, m/s² per count."""

RIG = Rig(base=Base(bias_dps=0.3))

FrameOf = Callable[..., bytes]
Vector = tuple[int, int, int]


class Header:
    """Its functions, by ctypes."""

    def __init__(self, library: Path) -> None:
        self._library = ctypes.CDLL(str(library))
        c = ctypes
        self._library.hello_frame.argtypes = [c.c_char_p, c.c_uint16, c.c_float, c.c_uint32, c.c_char_p]
        fields = [c.c_uint8, c.c_uint16, c.c_uint32, c.c_int16, c.c_int16, c.c_int32]
        self._library.sample_frame.argtypes = [c.c_char_p, *fields]
        self._library.hello3_frame.argtypes = [c.c_char_p, c.c_uint16, c.c_float, c.c_uint32, c.c_char_p, c.c_float]
        axes = c.POINTER(c.c_int16)
        self._library.sample3_frame.argtypes = [
            c.c_char_p,
            c.c_uint8,
            c.c_uint16,
            c.c_uint32,
            axes,
            c.c_int16,
            c.c_int32,
        ]
        hello = self._library.hello3_frame.argtypes
        self._library.hello_filter_frame.argtypes = [*hello[:-1], c.c_uint8, c.c_float, c.c_uint8]
        self._library.yaw_frame.argtypes = [c.c_char_p, c.c_uint16, c.c_uint32, c.c_float, c.c_float, c.c_float]

    def hello(self, sample_rate_hz: int, dps_per_lsb: float, encoder_cpr: int, device_id: bytes) -> bytes:
        return self._framed(self._library.hello_frame, sample_rate_hz, dps_per_lsb, encoder_cpr, device_id)

    def sample(self, *fields: int) -> bytes:
        return self._framed(self._library.sample_frame, *fields)

    def hello3(self, *fields: object) -> bytes:
        return self._framed(self._library.hello3_frame, *fields)

    def hello_filter(self, *fields: object) -> bytes:
        return self._framed(self._library.hello_filter_frame, *fields)

    def yaw(self, *fields: float) -> bytes:
        return self._framed(self._library.yaw_frame, *fields)

    def sample3(
        self, flags: int, seq: int, t_us: int, gyro_raw: Vector, accel_raw: Vector, temp: int, counts: int
    ) -> bytes:
        axes = (ctypes.c_int16 * 6)(*gyro_raw, *accel_raw)
        return self._framed(self._library.sample3_frame, flags, seq, t_us, axes, temp, counts)

    @staticmethod
    def _framed(write: Callable[..., int], *fields: object) -> bytes:
        buffer = ctypes.create_string_buffer(b"\xaa" * 64, 64)
        length = write(buffer, *fields)
        assert set(buffer.raw[length:]) == {0xAA}
        return buffer.raw[:length]


@pytest.fixture(scope="module")
def header(tmp_path_factory: pytest.TempPathFactory) -> Header:
    return Header(compiled("native_header.c", tmp_path_factory.mktemp("header"), "-shared", "-fPIC"))


def test_hello_is_the_golden_one(header: Header) -> None:
    assert header.hello(100, 0.00763, 36000, b"firmware_sim") == HELLO


@pytest.mark.parametrize("sample", SAMPLES)
def test_samples_are_the_golden_ones(header: Header, sample: NativeSample) -> None:
    assert header.sample(*sample) == SAMPLES[sample]


def test_frames_of_three_axes_are_the_golden_ones(header: Header) -> None:
    assert header.hello3(100, 0.00763, 36000, b"firmware_sim", AXES_HELLO_MPS2) == AXES_HELLO


@pytest.mark.parametrize("sample", AXES_SAMPLES)
def test_samples_of_three_axes_are_the_golden_ones(header: Header, sample: NativeSample3) -> None:
    assert header.sample3(*sample) == AXES_SAMPLES[sample]


def test_hello_of_a_device_that_runs_a_filter_is_the_golden_one(header: Header) -> None:
    assert header.hello_filter(100, 0.00763, 36000, b"firmware_sim", 1, 0.0, 2) == FILTER_HELLO
    assert header.hello_filter(100, 0.00763, 36000, b"firmware_sim", 3, AXES_HELLO_MPS2, 3) == AXES_FILTER_HELLO


@pytest.mark.parametrize("yaw", YAWS)
def test_yaws_are_the_golden_ones(header: Header, yaw: NativeYaw) -> None:
    assert header.yaw(*yaw) == YAWS[yaw]


@given(u16, u32, f32, f32, f32)
def test_any_yaw_has_the_bytes_of_the_simulated_device(
    header: Header, seq: int, t_us: int, yaw_deg: float, sigma_deg: float, bias_dps: float
) -> None:
    """Two encoders that share nothing agree on every field, infinities and NaN too."""
    assert header.yaw(seq, t_us, yaw_deg, sigma_deg, bias_dps) == yaw_frame(seq, t_us, yaw_deg, sigma_deg, bias_dps)


@given(st.integers(0, 255), u16, u32, st.tuples(i16, i16, i16), st.tuples(i16, i16, i16), i16, i32)
def test_any_sample_of_three_axes_has_the_bytes_of_the_simulated_device(
    header: Header, flags: int, seq: int, t_us: int, gyro: Vector, accel: Vector, temp: int, counts: int
) -> None:
    """Two encoders that share nothing agree on every field."""
    expected = axes_sample_frame(flags, seq, t_us, gyro, accel, temp, counts)
    assert header.sample3(flags, seq, t_us, gyro, accel, temp, counts) == expected


@given(st.integers(0, 255), u16, u32, i16, i16, i32)
def test_any_sample_has_the_bytes_of_the_simulated_device(
    header: Header, flags: int, seq: int, t_us: int, rate: int, temp: int, counts: int
) -> None:
    """Two encoders that share nothing agree on every field."""
    assert header.sample(flags, seq, t_us, rate, temp, counts) == sample_frame(flags, seq, t_us, rate, temp, counts)


@given(u16, st.floats(width=32, min_value=SCALES[0], max_value=SCALES[1]), u32, st.binary(max_size=24))
def test_any_hello_is_read_back(header: Header, rate_hz: int, scale: float, cpr: int, name: bytes) -> None:
    decoder = NativeDecoder()
    assert decoder.push(header.hello(rate_hz, scale, cpr, name)) == []
    assert decoder.counters.damaged == 0
    heard = decoder.device
    assert (heard.sample_rate_hz, heard.dps_per_lsb, heard.encoder_cpr) == (rate_hz or None, scale, cpr or None)
    statement = name.partition(b"\0")[0][:16].decode("ascii", "replace")
    assert heard.device_id == "".join(item if item.isprintable() else "\ufffd" for item in statement)


def test_the_stream_that_decoders_are_damaged_with_is_the_same(header: Header) -> None:
    base = load_rig(None).base
    sent = [header.hello(round(base.sample_rate_hz), base.dps_per_lsb, base.encoder_cpr, b"firmware_sim")]
    for block in islice(measure(RIG, load_profile("turntable"), seed=3), 1):
        for seq, t_us, _, rate_raw, _, temp, counts, _ in islice(block.rows(), 99):
            sent.append(header.sample(3, seq, t_us, rate_raw, temp, counts))
    frames = islice(native.frames(measure(RIG, load_profile("turntable"), seed=3), base), 100)
    assert b"".join(sent) == b"".join(frame.content for frame in frames)


@given(
    st.lists(st.tuples(u16, i16, i16), min_size=1, max_size=30),
    st.lists(st.tuples(st.integers(0, 1 << 12), st.binary(min_size=1, max_size=8)), max_size=4),
)
def test_damage_costs_the_frames_that_it_hits(
    header: Header, measured: list[tuple[int, int, int]], damage: list[tuple[int, bytes]]
) -> None:
    frames = [header.sample(2, seq, 5000 * i, rate, temp, 0) for i, (seq, rate, temp) in enumerate(measured)]
    stream = bytearray(b"".join(frames))
    for position, junk in damage:
        start = position % len(stream)
        stream[start : start + len(junk)] = junk[: len(stream) - start]
    whole = [stream[20 * i : 20 * i + 20] == frame for i, frame in enumerate(frames)]
    decoder = NativeDecoder()
    decoder.push(header.hello(200, 1.0, 0, b""))
    read = {reading.t_us: reading for reading in decoder.push(b"\0" + bytes(stream) + b"\0")}
    assert read.keys() <= {5000 * i for i in range(len(measured))}
    for i, (seq, rate, temp) in enumerate(measured):
        is_clean = whole[i] and (i == 0 or stream[20 * i - 1] == 0)
        assert not is_clean or 5000 * i in read
        if 5000 * i in read:
            reading = read[5000 * i]
            assert (reading.seq, reading.rate_dps, reading.temp_c) == (seq, float(rate), temp / 100.0)


@pytest.mark.parametrize("standard", ["c99", "c11", "c17"])
def test_it_is_clean_c(standard: str) -> None:
    if shutil.which("cc") is None:
        pytest.skip("there is no C compiler: apt-get install gcc")
    assert run("cc", f"-std={standard}", "-x", "c", *PEDANTIC, HEADERS / "gyrodrift_native.h") == ""


@pytest.mark.parametrize("standard", ["c++98", "c++11", "c++17"])
def test_it_is_clean_cpp(standard: str) -> None:
    if shutil.which("c++") is None:
        pytest.skip("there is no C++ compiler: apt-get install g++")
    assert run("c++", f"-std={standard}", "-x", "c++", *PEDANTIC, HEADERS / "gyrodrift_native.h") == ""


PEDANTIC = (*STRICT, "-pedantic", "-Wconversion", "-Wsign-conversion", "-Wshadow", "-fsyntax-only")


def test_it_needs_nothing_of_a_system(tmp_path: Path) -> None:
    if shutil.which("avr-gcc") is None:
        pytest.skip("there is no compiler for AVR: apt-get install gcc-avr avr-libc")
    built = tmp_path / "header.o"
    run("avr-gcc", *UNO, *STRICT, f"-I{HEADERS}", "-c", Path(__file__).parent / "native_header.c", "-o", built)
    assert {line.split()[-1] for line in run("avr-nm", "-u", built).splitlines()} <= {"memcpy", "__do_copy_data"}
    _, _, data, bss, *_ = ("", *run("avr-size", built).splitlines()[1].split())
    assert (data, bss) == ("0", "0")
