"""Frames of the device, against independent frames and codecs of other people."""

import binascii
import struct
from collections.abc import Iterator
from itertools import islice

import numpy as np
import pytest
from cobs import cobs
from golden_frames import (
    AXES_HELLO,
    AXES_SAMPLES,
    HELLO,
    NO_ACCELEROMETER_HELLO,
    RVC_FRAME,
    SAMPLES,
    VECTORNAV_ANGLES,
    WT901_ACCELERATION,
    WT901_RATES,
    NativeSample,
    NativeSample3,
)
from hypothesis import given
from hypothesis import strategies as st
from pynmeagps import NMEAReader

from firmware_sim.measure import Block, StillWord, TriaxialBlock, measure
from firmware_sim.motion.profile import config_folder, load_motion, load_profile
from firmware_sim.rig import Base, Rig, load_rig, parse_effect, with_effects
from firmware_sim.wire import bno08x_rvc, csv, native, nmea, vectornav, witmotion, xsens
from firmware_sim.wire.registry import ENCODERS
from gyrodrift.link.protocols.decoder import DeviceDescription
from gyrodrift.link.protocols.native import NativeDecoder
from gyrodrift.values.sample import Reading

i16 = st.integers(-32768, 32767)
finite = st.floats(allow_nan=False, allow_infinity=False)
ENDLESS = st.integers(0, 2**50)


def blocks_of(base: Base) -> Iterator[Block]:
    return measure(Rig(base=base), load_profile("turntable"), 0, block_samples=512)


def block_at(seq: int, t_us: int, rate_raw: int = 0, encoder_counts: int = 0, t_host_s: float = 0.1) -> Iterator[Block]:
    """A block of one measurement."""
    yield Block(
        seq=np.array([seq]),
        t_device_us=np.array([t_us]),
        t_host_s=np.array([t_host_s]),
        rate_raw=np.array([rate_raw], dtype=np.int16),
        is_clipped=np.array([False]),
        temp_centi_c=np.array([2500], dtype=np.int16),
        encoder_counts=np.array([encoder_counts]),
        still=np.array([-1], dtype=np.int8),
    )


def opened(frame: bytes) -> bytes:
    """The payload of a native frame by other people's codecs, its CRC checked."""
    assert frame.endswith(b"\0")
    packet: bytes = cobs.decode(frame[:-1])
    assert packet[-2:] == struct.pack("<H", binascii.crc_hqx(packet[:-2], 0xFFFF))
    return packet[:-2]


def sample_of(frame: bytes) -> NativeSample:
    kind, *fields = struct.unpack("<BBHIhhi", opened(frame))
    assert kind == 0x02
    return NativeSample(*fields)


def test_hello_is_the_golden_one() -> None:
    """The shipped rig introduces itself with the bytes worked out from the protocol."""
    assert native.hello_frame(load_rig(None).base) == HELLO


@pytest.mark.parametrize("sample", SAMPLES)
def test_samples_are_the_golden_ones(sample: NativeSample) -> None:
    assert native.sample_frame(*sample) == SAMPLES[sample]


def test_hello_version_2_is_the_golden_one() -> None:
    base = load_rig(None).base
    assert native.axes_hello_frame(base, 0.0047884) == AXES_HELLO
    without = base.model_copy(update={"encoder_cpr": 0})
    assert native.axes_hello_frame(without, 0.0) == NO_ACCELEROMETER_HELLO


@pytest.mark.parametrize("sample", AXES_SAMPLES)
def test_samples_of_three_axes_are_the_golden_ones(sample: NativeSample3) -> None:
    assert native.axes_sample_frame(*sample) == AXES_SAMPLES[sample]


@pytest.mark.parametrize(("flags", "axes_flags"), [(0x07, 0x07), (0x08, 0x08), (0x18, 0x28)])
def test_flags_of_three_axes_have_another_bit_for_rest(flags: int, axes_flags: int) -> None:
    """The bit of rest in SAMPLE is that of the acceleration in SAMPLE3."""
    assert native.axes_flags(flags) == axes_flags


@pytest.mark.parametrize("rate_and_temperature", WT901_RATES)
def test_witmotion_rates_are_the_golden_ones(rate_and_temperature: tuple[int, int]) -> None:
    assert witmotion.wt901_frame(0x52, 0, 0, *rate_and_temperature) == WT901_RATES[rate_and_temperature]


def test_witmotion_acceleration_is_the_golden_one() -> None:
    """A level device feels 1 g on its z axis."""
    assert witmotion.wt901_sample(0.0, 2500)[:11] == WT901_ACCELERATION


def test_the_example_of_the_vectornav_manual_is_met() -> None:
    assert vectornav.vectornav_frame(0x0008, VECTORNAV_ANGLES[4:-2]) == VECTORNAV_ANGLES


def test_the_example_of_the_bno08x_data_sheet_is_met() -> None:
    """Index, angles in hundredths of a degree, accelerations in mg."""
    assert bno08x_rvc.rvc_frame(222, 1, -110, 2085, -371, -20, 977) == RVC_FRAME


def test_a_message_of_the_xsens_protocol_is_met() -> None:
    """OutputConfiguration as a device sends it, by its items; all bytes but the first add up to 0."""
    message = xsens.mtdata2(xsens.item(0x1020, b"\xff\xff") + xsens.item(0x1060, bytes(4)))
    assert message.hex() == "faff360c102002ffff10600400000000%02x" % (-sum(message[1:-1]) & 0xFF)


def test_a_rate_of_turn_is_read_by_a_library() -> None:
    result = NMEAReader.parse(nmea.rate_of_turn(2.5))
    assert (result.identity, result.rot, result.valid) == ("HEROT", -150.0, "A")
    assert nmea.rate_of_turn(0.0).startswith(b"$HEROT,0.00,A*")


@given(st.binary(max_size=254))
def test_stuffing_is_that_of_the_cobs_package(packet: bytes) -> None:
    assert native.cobs_encode(packet) == cobs.encode(packet)
    assert 0 not in native.cobs_encode(packet)


@given(st.binary())
def test_the_crc_is_that_of_binascii(payload: bytes) -> None:
    assert native.crc16_ccitt_false(payload) == binascii.crc_hqx(payload, 0xFFFF)


def test_the_crc_of_the_catalogue_is_met() -> None:
    """The check value of CRC-16/CCITT-FALSE in every catalogue is that of the digits 1 to 9."""
    assert native.crc16_ccitt_false(b"123456789") == 0x29B1


@given(st.floats(1.0, 65535.0), st.floats(1e-6, 10.0), st.integers(0, 2**31 // 360))
def test_hello_tells_rate_scale_and_encoder(rate_hz: float, lsb_dps: float, cpr: int) -> None:
    """The fields are those of the rig: rate in whole Hz, scale as a 32-bit float."""
    base = Base(sample_rate_hz=rate_hz, dps_per_lsb=lsb_dps, encoder_cpr=cpr)
    fields = struct.unpack("<BBHfI16s", opened(native.hello_frame(base)))
    assert fields == (1, 1, round(rate_hz), np.float32(lsb_dps), cpr, b"firmware_sim".ljust(16, b"\0"))


@given(st.integers(0, 7), ENDLESS, ENDLESS, i16, i16, st.integers(-(2**40), 2**40))
def test_counter_clock_and_encoder_wrap(flags: int, seq: int, t_us: int, rate: int, temp: int, counts: int) -> None:
    """Numbers of any size leave as the low bits that the wire has room for; the others are untouched."""
    sample = sample_of(native.sample_frame(flags, seq, t_us, rate, temp, counts))
    assert sample[:3] == (flags, seq % 2**16, t_us % 2**32)
    assert sample[3:5] == (rate, temp)
    assert (sample.encoder_counts - counts) % 2**32 == 0


def test_a_running_device_wraps_its_counter_and_its_clock() -> None:
    """The sample after number 65535 has number 0, and the clock starts again after 71.6 minutes."""
    _, frame = native.frames(block_at(2**16, 2**32 + 5), Base())
    assert sample_of(frame.content)[1:3] == (0, 5)


@pytest.mark.parametrize("rate_hz", [1.0, 7.0, 33.3, 100.0, 1000.0])
def test_hello_comes_first_and_once_a_second(rate_hz: float) -> None:
    """The first frame of each second is HELLO, and the only one."""
    base = Base(sample_rate_hz=rate_hz)
    frames = list(islice(native.frames(blocks_of(base), base), round(rate_hz * 4.5) + 5))
    hellos = [frame for frame in frames if frame.rows == 0]
    assert frames[0] is hellos[0]
    assert {frame.content for frame in hellos} == {native.hello_frame(base)}
    assert [int(frame.t_s) for frame in hellos] == list(range(len(hellos)))
    assert len(hellos) == int(frames[-1].t_s) + 1


def test_native_frames_carry_the_measurements_in_order() -> None:
    """Every measurement becomes one sample, when the host has it, with nothing changed."""
    base = load_rig(None).base
    frames = (frame for frame in native.frames(blocks_of(base), base) if frame.rows)
    rows = (row for block in blocks_of(base) for row in block.rows())
    for frame, (seq, t_us, t_host_s, raw, _, temp, counts, _) in islice(zip(frames, rows, strict=False), 1500):
        assert sample_of(frame.content) == (3, seq, t_us, raw, temp, counts)
        assert frame.t_s == t_host_s == pytest.approx(t_us * 1e-6 + base.host_delay_s)


@pytest.mark.parametrize("protocol", ENCODERS)
def test_the_time_of_a_frame_is_exact(protocol: str) -> None:
    """A frame has the time at which the host has its measurement, to the last bit."""
    *_, frame = ENCODERS[protocol].frames(block_at(10, 100_000, t_host_s=0.1023), Base())
    assert frame.t_s == 0.1023


def test_the_flags_say_what_is_valid() -> None:
    base = Base(encoder_cpr=0, bias_dps=50.0, dps_per_lsb=0.001, noise_dps_rthz=0.0)
    _, frame = islice(native.frames(blocks_of(base), base), 2)
    assert (sample_of(frame.content).flags, sample_of(frame.content).rate_raw) == (0b110, 32767)


@given(st.integers(0, 2**32 - 1), finite, finite, finite)
def test_a_csv_line_reads_back_to_the_same_numbers(t_us: int, rate: float, angle: float, temp: float) -> None:
    """The digits are as many as it takes to tell a number from every other one."""
    line = csv.csv_line(t_us, rate, angle, temp)
    assert line.endswith(b"\r\n")
    first, *rest = line.decode().split(",")
    assert (int(first), *map(float, rest)) == (t_us, rate, angle, temp)


@pytest.mark.parametrize(
    ("angle_deg", "temp_c", "line"),
    [
        (1.5, 25.0, b"7,-0.25,1.5,25.0\r\n"),
        (1.5, None, b"7,-0.25,1.5\r\n"),
        (None, 25.0, b"7,-0.25,nan,25.0\r\n"),
        (None, None, b"7,-0.25\r\n"),
    ],
)
def test_a_csv_line_leaves_out_what_is_absent(angle_deg: float | None, temp_c: float | None, line: bytes) -> None:
    assert csv.csv_line(7, -0.25, angle_deg, temp_c) == line


@given(i16, st.integers(-(10**7), 10**7))
def test_a_csv_line_tells_the_counts_of_the_shipped_rig(rate_raw: int, counts: int) -> None:
    """The rounded numbers of the text still give back every count of gyro and encoder."""
    base = load_rig(None).base
    _, frame = csv.frames(block_at(0, 0, rate_raw, counts), base)
    _, rate_dps, angle_deg, temp_c = map(float, frame.content.decode().split(","))
    assert round(rate_dps / base.dps_per_lsb) == rate_raw
    assert round(angle_deg / 360.0 * base.encoder_cpr) == counts
    assert temp_c == 25.0


@pytest.mark.parametrize("base", [Base(dps_per_lsb=1e-6), Base(encoder_cpr=2**31 // 360)])
def test_a_csv_line_tells_the_counts_of_the_finest_rig(base: Base) -> None:
    """A rig that is accepted is not made coarser by the text."""
    _, frame = csv.frames(block_at(0, 0, 1, 1), base)
    _, rate_dps, angle_deg, _ = map(float, frame.content.decode().split(","))
    assert (round(rate_dps / base.dps_per_lsb), round(angle_deg / 360.0 * base.encoder_cpr)) == (1, 1)


def test_csv_opens_with_a_comment_and_wraps_its_clock() -> None:
    """The banner names the columns, and the clock is that of a 32-bit device."""
    banner, frame = csv.frames(block_at(0, 2**32 + 5), Base())
    assert (banner.rows, banner.content) == (0, b"# t_us,rate_dps,encoder_deg,temp_c\r\n")
    assert frame.content.startswith(b"5,")


def test_csv_without_encoder_has_no_angle() -> None:
    """The temperature stays in its column."""
    _, frame = csv.frames(block_at(0, 0), Base(encoder_cpr=0))
    assert frame.content == b"0,0.0,nan,25.0\r\n"


@given(st.integers(0, 255), st.tuples(i16, i16, i16, i16))
def test_a_witmotion_frame_ends_with_its_sum(kind: int, values: tuple[int, int, int, int]) -> None:
    """Eleven bytes: head, kind, four values and the low byte of the sum of all before."""
    frame = witmotion.wt901_frame(kind, *values)
    assert struct.unpack("<BB4h", frame[:10]) == (0x55, kind, *values)
    assert frame[10:] == bytes([sum(frame[:10]) % 256])


@given(st.floats(-1999.9, 1999.9), i16)
def test_a_witmotion_sample_holds_the_nearest_count(rate_dps: float, temp_centi_c: int) -> None:
    frame = witmotion.wt901_sample(rate_dps, temp_centi_c)[11:22]
    head, kind, _, _, raw, temp = struct.unpack("<BB4h", frame[:10])
    assert (head, kind, temp) == (0x55, 0x52, temp_centi_c)
    assert abs(raw * 2000.0 / 32768.0 - rate_dps) <= 1000.0 / 32768.0 * (1 + 1e-9)


@pytest.mark.parametrize(("rate_dps", "raw"), [(2000.0, 32767), (1e9, 32767), (-2000.0, -32767), (-1e9, -32767)])
def test_a_witmotion_rate_saturates(rate_dps: float, raw: int) -> None:
    assert struct.unpack("<h", witmotion.wt901_sample(rate_dps, 2500)[17:19]) == (raw,)


def test_witmotion_says_three_frames_for_each_measurement() -> None:
    """Acceleration, rates and angles leave together, at the time of their measurement."""
    base = Base()
    for number, frame in enumerate(islice(witmotion.frames(blocks_of(base), base), 600)):
        assert [frame.content[motion_at : motion_at + 2] for motion_at in (0, 11, 22)] == [
            b"\x55\x51",
            b"\x55\x52",
            b"\x55\x53",
        ]
        assert (len(frame.content), frame.rows) == (33, 1)
        assert frame.t_s == pytest.approx(number * 0.01 + base.host_delay_s)


@pytest.mark.parametrize("word", StillWord)
def test_a_device_that_is_told_to_says_whether_it_stands_still(word: StillWord) -> None:
    profile, base = load_profile("turntable"), Base(sample_rate_hz=20.0)

    def blocks() -> Iterator[Block]:
        return measure(Rig(base=base), profile, 0, block_samples=512, still=word)

    block = next(blocks())
    _, rate_dps = profile.motion_at(block.seq / 20.0)
    true = {StillWord.NONE: rate_dps * 0 - 1, StillWord.ALWAYS: rate_dps * 0 + 1, StillWord.NEVER: rate_dps * 0}
    expected = true.get(word, (rate_dps == 0.0) * 1.0).tolist()
    assert len(set(expected)) == (2 if word is StillWord.TRUE else 1)
    frames = [f.content for f in islice(native.frames(blocks(), base), 600) if f.rows]
    flags = [opened(frame)[1] for frame in frames[:500]]
    assert [(flag >> 4 & 1) if flag & 8 else -1 for flag in flags] == expected[:500]
    lines = [f.content.decode().strip().split(",") for f in islice(ENCODERS["csv"].frames(blocks(), base), 501)][1:]
    assert [float(line[4]) if len(line) > 4 else -1 for line in lines] == expected[:500]


def axes_readings(
    text: str, still: StillWord = StillWord.NONE
) -> tuple[TriaxialBlock, list[Reading], DeviceDescription]:
    """A block of a rig with three axes and an effect, and what a decoder reads from its native frames."""
    rig = with_effects(load_rig(config_folder() / "rig-three-axes.yaml"), [parse_effect(text)])
    block = next(measure(rig, load_motion("hand"), 0, block_samples=600, still=still))
    assert isinstance(block, TriaxialBlock)
    decoder = NativeDecoder()
    readings = [r for frame in native.frames([block], rig.base) for r in decoder.push(frame.content)]
    return block, readings, decoder.device


def test_native_frames_carry_all_axes() -> None:
    block, readings, device = axes_readings("accel_bias")
    assert (device.sample_rate_hz, device.encoder_cpr) == (100.0, 36000)
    for reading, (gyro_raw, accel_raw, _) in zip(readings, block.axes_rows(), strict=True):
        assert reading.inertial is not None
        assert accel_raw is not None
        assert reading.inertial[:3] == pytest.approx([count * 0.0152588 for count in gyro_raw], rel=1e-6)
        assert reading.inertial[3:] == pytest.approx([count * 0.0023942 for count in accel_raw], rel=1e-6)


def test_native_frames_say_where_acceleration_is_missing() -> None:
    block, readings, _ = axes_readings("accel_dropout:from_s=1,to_s=2", StillWord.TRUE)
    has_none = [reading.inertial is not None and np.isnan(reading.inertial.accel_x_mps2) for reading in readings]
    assert np.flatnonzero(has_none).tolist() == list(range(100, 200))
    assert [reading.still for reading in readings] == block.still.tolist()
    assert {reading.still for reading in readings} == {0, 1}


def test_the_greeting_of_a_device_with_three_axes_is_the_second_version() -> None:
    """A new reader knows the scales before the first sample."""
    base = load_rig(config_folder() / "rig-three-axes.yaml").base
    assert native.ENCODER.hello(base) == native.axes_hello_frame(base, 0.0023942)
    assert native.ENCODER.hello(load_rig(None).base) == HELLO
