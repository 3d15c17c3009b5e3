"""The native protocol, from frames worked out by hand."""

import struct
from math import isnan

import golden_frames as golden
import pytest
from golden_frames import NativeSample
from support import near

from firmware_sim.wire.native import native_frame, sample_frame
from gyrodrift.link.protocols.decoder import DeviceDescription
from gyrodrift.link.protocols.native import NativeDecoder

LSB = 0.007629999890923500
"""0.00763 as the nearest 32-bit float."""


def test_hello_describes_the_device() -> None:
    """Of the device and its scale."""
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


def test_samples_before_hello_are_dropped_and_counted() -> None:
    """Their scale would be a guess."""
    decoder = NativeDecoder()
    frames = b"".join(golden.SAMPLES.values())
    assert decoder.push(frames) == []
    assert decoder.counters.before_hello == len(golden.SAMPLES)
    assert len(decoder.push(golden.HELLO + frames)) == len(golden.SAMPLES)


@pytest.mark.parametrize(
    ("frame", "damaged", "other"),
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
def test_what_is_not_a_frame_we_know_is_counted(frame: bytes, damaged: int, other: int) -> None:
    """As damaged, or as good but of no use."""
    decoder = NativeDecoder()
    assert decoder.push(frame) == []
    assert (decoder.counters.damaged, decoder.counters.other) == (damaged, other)


def test_a_hello_of_another_version_or_without_a_scale_is_not_believed() -> None:
    """A later protocol may mean something else by its fields."""
    decoder = NativeDecoder()
    body = b"\x00d\x00\x00\x00\x00\x00" + b"\x00" * 20
    decoder.push(native_frame(b"\x01\x02" + body[1:]) + native_frame(b"\x01\x01" + body[1:]))
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
    """Whatever is no printable ASCII is told from what is."""
    decoder = NativeDecoder()
    decoder.push(hello(0.01, b"a\x1b[2J\x07\n\xff b"))
    assert decoder.device.device_id == "a\ufffd[2J\ufffd\ufffd\ufffd b"


@pytest.mark.parametrize(("flags", "still"), [(0x00, None), (0x10, None), (0x08, 0.0), (0x18, 1.0)])
def test_two_flags_say_whether_the_device_stands_still(flags: int, still: float | None) -> None:
    """One that it is known, one what it is."""
    decoder = NativeDecoder()
    (reading,) = decoder.push(golden.HELLO + sample_frame(flags, 1, 10_000, 5, 0, 0))
    assert reading.still == still if still is not None else isnan(reading.still)
