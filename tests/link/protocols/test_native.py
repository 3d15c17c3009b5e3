"""The native protocol, from frames worked out by hand."""

import struct
from math import isnan

import golden_frames as golden
import pytest
from cobs import cobs
from golden_frames import NativeSample, NativeSample3
from support import near

from firmware_sim.wire.native import axes_sample_frame, native_frame, sample_frame
from gyrodrift.link.protocols.decoder import WAITING_MAX, DeviceDescription
from gyrodrift.link.protocols.guard import renewed
from gyrodrift.link.protocols.native import NativeDecoder
from gyrodrift.link.protocols.registry import PROTOCOLS
from gyrodrift.values.sample import Inertial, Reading

LSB = 0.007629999890923500
"""0.00763 as the nearest 32-bit float."""


def test_hello_describes_the_device() -> None:
    decoder = NativeDecoder()
    assert decoder.push(golden.HELLO) == []
    assert decoder.device == DeviceDescription("firmware_sim", 100.0, near(LSB), 36000)


@pytest.mark.parametrize("sample", golden.SAMPLES)
def test_a_golden_sample_is_read_field_by_field(sample: NativeSample) -> None:
    """Rates by the scale of HELLO, the rest by the flags."""
    decoder = NativeDecoder()
    (reading,) = decoder.push(golden.HELLO + golden.SAMPLES[sample])
    assert (reading.t_us, reading.seq) == (sample.t_us, sample.seq)
    assert reading.rate_dps == pytest.approx(sample.rate_raw * LSB, rel=1e-12)
    assert decoder.counters.clipped == (sample.flags >> 2 & 1)
    if sample.flags & 1:
        assert reading.encoder_deg == pytest.approx(sample.encoder_counts * 0.01)
        assert reading.temp_c == sample.temp_centi_c / 100
    else:
        assert isnan(reading.encoder_deg)
        assert isnan(reading.temp_c)


ALL_FRAMES = [golden.HELLO, golden.AXES_HELLO, *golden.SAMPLES.values(), *golden.AXES_SAMPLES.values()]


@pytest.mark.parametrize("frame", ALL_FRAMES, ids=range(len(ALL_FRAMES)))
def test_no_flipped_bit_passes_the_crc(frame: bytes) -> None:
    body = cobs.decode(frame[:-1])
    flips = [1 << bit for bit in range(8 * len(body))]
    in_crc = flips[-16:]
    for flip in [*flips, *(item ^ second for item in in_crc for second in in_crc if item < second)]:
        damaged = (int.from_bytes(body, "little") ^ flip).to_bytes(len(body), "little")
        decoder = NativeDecoder()
        decoder.push(cobs.encode(damaged) + b"\0")
        assert (decoder.counters.damaged, decoder.counters.frames) == (1, 0)


def run(count: int, seq: int = 0, t_us: int = 0, step_us: int = 10_000) -> bytes:
    """Samples one behind the other; their rates are their places."""
    return b"".join(
        sample_frame(0, (seq + i) % 65536, (t_us + i * step_us) % 2**32, i % 1000, 0, 0) for i in range(count)
    )


def seqs(readings: list[Reading]) -> list[int | None]:
    return [reading.seq for reading in readings]


@pytest.mark.promise("Samples")
def test_samples_before_hello_wait_for_their_scale() -> None:
    """Samples before a HELLO wait for it, and are then scaled."""
    decoder = NativeDecoder()
    assert decoder.push(run(50)) == []
    assert (decoder.counters.before_hello, decoder.counters.late) == (50, 0)
    readings = decoder.push(golden.HELLO + run(2, seq=50, t_us=500_000))
    assert seqs(readings) == list(range(52))
    assert [reading.rate_dps for reading in readings[:50]] == [i * LSB for i in range(50)]
    assert (decoder.counters.before_hello, decoder.counters.late) == (0, 50)


def test_samples_without_hello_are_counted_and_never_guessed() -> None:
    decoder = NativeDecoder()
    assert decoder.push(run(500)) == []
    assert decoder.counters.before_hello == 500


@pytest.mark.promise("Samples")
@pytest.mark.parametrize(
    ("seq", "t_us"),
    [(0, 0), (51, 500_000_000), (50, 2**32 - 1), (9000, 500_000), (4000, 700_000)],
    ids=["booted", "clock far ahead", "clock behind", "counter far ahead", "another clock and counter"],
)
def test_samples_of_another_device_are_not_scaled_with_this_one(seq: int, t_us: int) -> None:
    """No sample is scaled with the HELLO of another device."""
    decoder = NativeDecoder()
    decoder.push(run(50))
    readings = decoder.push(golden.HELLO + run(3, seq=seq, t_us=t_us))
    assert seqs(readings) == [(seq + i) % 65536 for i in range(3)]
    assert (decoder.counters.before_hello, decoder.counters.late) == (50, 0)


def test_of_samples_that_wait_only_those_behind_the_last_break_are_scaled() -> None:
    """The device was exchanged, or booted, while it waited."""
    decoder = NativeDecoder()
    readings = decoder.push(run(30, seq=700, t_us=9_000_000) + run(20) + golden.HELLO + run(1, seq=20, t_us=200_000))
    assert seqs(readings) == list(range(21))
    assert (decoder.counters.before_hello, decoder.counters.late) == (30, 20)


def test_a_hole_is_no_break_where_counter_and_clock_tell_the_same_of_it() -> None:
    decoder = NativeDecoder()
    kept = run(10, seq=65_500, t_us=2**32 - 600_000)
    readings = decoder.push(kept + golden.HELLO + run(1, seq=464, t_us=4_400_000))
    assert len(readings) == 11


def test_a_device_that_is_known_gets_all_its_samples_scaled_though_it_booted_meanwhile() -> None:
    old = NativeDecoder()
    old.push(golden.HELLO)
    expected, second = renewed(PROTOCOLS["native"], old), renewed(PROTOCOLS["native"], old)
    kept = run(30, seq=700, t_us=9_000_000) + run(20)
    assert expected.push(kept) == second.push(kept) == []
    assert len(expected.push(golden.HELLO + run(1, seq=5000, t_us=123))) == 51
    assert len(second.push(hello(LSB, b"stranger") + run(1, seq=5000, t_us=123))) == 1


@pytest.mark.promise("Samples")
def test_samples_that_wait_are_bounded_and_the_oldest_go_first() -> None:
    """At most 65 536 samples wait for a HELLO; then the oldest is dropped. `before_hello` counts them."""
    decoder = NativeDecoder()
    for start in range(0, WAITING_MAX + 1000, 1000):
        decoder.push(run(1000, seq=start, t_us=start * 10_000))
    total = WAITING_MAX // 1000 * 1000 + 1000 + (0 if WAITING_MAX % 1000 == 0 else 1000)
    assert decoder.counters.before_hello == total
    readings = decoder.push(golden.HELLO + run(1, seq=total, t_us=total * 10_000))
    assert (len(readings), decoder.counters.late) == (WAITING_MAX + 1, WAITING_MAX)
    assert decoder.counters.before_hello == total - WAITING_MAX
    assert readings[0].seq == (total - WAITING_MAX) % 65536


@pytest.mark.parametrize(
    ("frame", "damaged", "peer"),
    [
        (native_frame(b""), 1, 0),
        (native_frame(b"\x02\x00"), 0, 1),
        (native_frame(b"\x07 something newer"), 0, 1),
        (b"\x05\x01\x02\x00", 1, 0),
        (b"\x01" * 200 + b"\x00", 1, 0),
        (b"\x00\x00\x00", 0, 0),
        (golden.HELLO[:-6] + b"\x00", 1, 0),
    ],
    ids=["no payload", "sample too short", "unknown type", "bad stuffing", "too long", "only zeros", "truncated"],
)
def test_what_is_not_a_frame_we_know_is_counted(frame: bytes, damaged: int, peer: int) -> None:
    decoder = NativeDecoder()
    assert decoder.push(frame) == []
    assert (decoder.counters.damaged, decoder.counters.other_frames) == (damaged, peer)


def test_a_hello_of_another_version_or_without_a_scale_is_not_believed() -> None:
    """A later protocol may mean something else by its fields."""
    decoder = NativeDecoder()
    body = b"\x00d\x00\x00\x00\x00\x00" + b"\x00" * 20
    decoder.push(native_frame(b"\x01\x02" + body[1:]) + native_frame(b"\x01\x01" + body[1:]))
    decoder.push(native_frame(b"\x01\x01" + body[1:] + bytes(5)) + native_frame(b"\x01"))
    assert decoder.device == DeviceDescription()
    assert decoder.push(next(iter(golden.SAMPLES.values()))) == []


def hello(scale: float, name: bytes = b"bench") -> bytes:
    return native_frame(struct.pack("<BBHfI16s", 1, 1, 100, scale, 36000, name))


@pytest.mark.parametrize("scale", [3e38, 11.0, 1e-12, 1e-45, -0.01, float("inf"), float("nan")])
def test_a_scale_that_no_gyro_has_is_damage(scale: float) -> None:
    """The checksum says that it came as it was sent, and not that it makes sense; the scale before it stays."""
    decoder = NativeDecoder()
    decoder.push(golden.HELLO + hello(scale))
    assert (decoder.device.dps_per_lsb, decoder.counters.damaged) == (near(LSB), 1)
    assert NativeDecoder().push(hello(scale) + next(iter(golden.SAMPLES.values()))) == []


def test_a_name_that_would_command_a_terminal_is_only_shown() -> None:
    decoder = NativeDecoder()
    decoder.push(hello(0.01, b"a\x1b[2J\x07\n\xff b"))
    assert decoder.device.device_id == "a\ufffd[2J\ufffd\ufffd\ufffd b"


@pytest.mark.parametrize(("flags", "still"), [(0x00, None), (0x10, None), (0x08, 0.0), (0x18, 1.0)])
def test_two_flags_say_whether_the_device_stands_still(flags: int, still: float | None) -> None:
    decoder = NativeDecoder()
    (reading,) = decoder.push(golden.HELLO + sample_frame(flags, 1, 10_000, 5, 0, 0))
    assert reading.still == still if still is not None else isnan(reading.still)


ACCEL_LSB = 0.004788400139659643
"""0.0047884 as the nearest 32-bit float."""


def test_hello_version_2_describes_axes_and_accelerometer() -> None:
    """A device without accelerometer sends the scale 0."""
    decoder = NativeDecoder()
    decoder.push(golden.AXES_HELLO)
    assert decoder.device == DeviceDescription("firmware_sim", 100.0, near(LSB), 36000, 3, near(ACCEL_LSB))
    decoder.push(golden.NO_ACCELEROMETER_HELLO)
    assert decoder.device == DeviceDescription("firmware_sim", 100.0, near(LSB), None, 3, None)


@pytest.mark.parametrize("sample", golden.AXES_SAMPLES)
def test_a_golden_sample_of_three_axes_is_read_field_by_field(sample: NativeSample3) -> None:
    """An acceleration that is clipped or not valid is missing."""
    decoder = NativeDecoder()
    (reading,) = decoder.push(golden.AXES_HELLO + golden.AXES_SAMPLES[sample])
    assert (reading.t_us, reading.seq) == (sample.t_us, sample.seq)
    assert reading.inertial is not None
    assert reading.inertial[:3] == pytest.approx([count * LSB for count in sample.gyro_raw], rel=1e-12)
    assert reading.rate_dps == reading.inertial.gyro_z_dps
    is_whole = sample.flags & 0x50 == 0x10
    expected_mps2 = [count * ACCEL_LSB if is_whole else float("nan") for count in sample.accel_raw]
    assert reading.inertial[3:] == pytest.approx(expected_mps2, rel=1e-12, nan_ok=True)
    assert decoder.counters.clipped == (sample.flags & 0x44 != 0)
    expected_still = {0x00: None, 0x08: 0.0, 0x28: 1.0}[sample.flags & 0x28]
    assert reading.still == expected_still if expected_still is not None else isnan(reading.still)
    assert isnan(reading.encoder_deg) == (not sample.flags & 1)


def test_samples_of_three_axes_wait_for_their_scales() -> None:
    decoder = NativeDecoder()
    assert decoder.push(b"".join(map(axes_sample, range(20)))) == []
    assert decoder.counters.before_hello == 20
    readings = decoder.push(golden.AXES_HELLO + axes_sample(20))
    assert seqs(readings) == list(range(21))
    assert readings[7].inertial == Inertial(LSB, 2 * LSB, 7 * LSB, 0.0, -ACCEL_LSB, 2048 * ACCEL_LSB)
    assert (decoder.counters.before_hello, decoder.counters.late) == (0, 20)


def axes_sample(seq: int) -> bytes:
    return axes_sample_frame(0x10, seq, seq * 10_000, (1, 2, seq), (0, -1, 2048), 0, 0)


def test_three_axes_after_hello_version_1_have_no_acceleration() -> None:
    """The scale of the rates is known, that of the accelerations is not."""
    (reading,) = NativeDecoder().push(golden.HELLO + axes_sample(3))
    assert reading.inertial is not None
    assert reading.rate_dps == reading.inertial.gyro_z_dps == 3 * LSB
    assert all(map(isnan, reading.inertial[3:]))


def test_a_single_axis_after_hello_version_2_stays_one() -> None:
    frame = native_frame(struct.pack("<BBHfI16sfB", 1, 2, 100, LSB, 36000, b"bench", 0.0, 1))
    decoder = NativeDecoder()
    (reading,) = decoder.push(frame + next(iter(golden.SAMPLES.values())))
    assert (decoder.device.axes, reading.inertial) == (1, None)


@pytest.mark.parametrize(("mps2_per_lsb", "axes"), [(-0.01, 3), (11.0, 3), (float("nan"), 3), (0.01, 2), (0.01, 0)])
def test_an_accelerometer_or_axes_that_no_device_has_are_damage(mps2_per_lsb: float, axes: int) -> None:
    frame = native_frame(struct.pack("<BBHfI16sfB", 1, 2, 100, LSB, 36000, b"bench", mps2_per_lsb, axes))
    decoder = NativeDecoder()
    decoder.push(golden.AXES_HELLO + frame)
    assert (decoder.device.mps2_per_lsb, decoder.counters.damaged) == (near(ACCEL_LSB), 1)


def test_a_damaged_frame_among_three_axes_costs_itself_alone() -> None:
    damaged = axes_sample(1)[:9] + b"\x7f" + axes_sample(1)[10:]
    decoder = NativeDecoder()
    readings = decoder.push(golden.AXES_HELLO + axes_sample(0) + damaged + axes_sample(2))
    assert (seqs(readings), decoder.counters.damaged) == ([0, 2], 1)
