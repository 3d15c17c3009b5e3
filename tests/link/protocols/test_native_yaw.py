"""Yaw of a device's own filter: joined with its sample, or counted, and nothing else is lost."""

import struct
from itertools import pairwise
from math import inf, isnan, nan

import golden_frames as golden
import pytest
from golden_frames import NativeYaw
from hypothesis import given
from hypothesis import strategies as st
from support import near

from firmware_sim.wire.native import axes_sample_frame, native_frame, sample_frame, yaw_frame
from gyrodrift.link.protocols.decoder import DeviceDescription
from gyrodrift.link.protocols.guard import renewed
from gyrodrift.link.protocols.native import MOST_BIAS_DPS, MOST_DEG, NativeDecoder
from gyrodrift.link.protocols.registry import PROTOCOLS
from gyrodrift.values.sample import DeviceYaw, Reading

OWN = DeviceYaw(12.5, 0.25, -0.5)
PERIOD_US = 10_000


def sample(seq: int) -> bytes:
    return sample_frame(0, seq % 65536, seq * PERIOD_US, seq % 1000, 0, 0)


def own_yaw(seq: int, yaw: DeviceYaw = OWN) -> bytes:
    return yaw_frame(seq, seq * PERIOD_US, *yaw)


def read(*frames: bytes) -> tuple[NativeDecoder, list[Reading]]:
    decoder = NativeDecoder()
    return decoder, decoder.push(b"".join(frames))


def yaws(readings: list[Reading]) -> dict[int | None, DeviceYaw | None]:
    return {reading.seq: reading.device_yaw for reading in readings}


@pytest.mark.parametrize("yaw", golden.YAWS)
def test_a_golden_yaw_is_read_field_by_field(yaw: NativeYaw) -> None:
    _, (reading,) = read(golden.FILTER_HELLO, sample_frame(0, yaw.seq, yaw.t_us, 5, 0, 0), golden.YAWS[yaw])
    assert reading.device_yaw == pytest.approx(yaw[2:], nan_ok=True)


def test_hello_version_3_names_the_filter() -> None:
    decoder, _ = read(golden.FILTER_HELLO)
    assert decoder.device == DeviceDescription("firmware_sim", 100.0, near(0.00763), 36000, 1, None, "restlevel")
    decoder.push(golden.AXES_FILTER_HELLO)
    assert (decoder.device.axes, decoder.device.device_filter) == (3, "attitude")


def hello(number: int, axes: int = 1) -> bytes:
    return native_frame(struct.pack("<BBHfI16sfBB", 1, 3, 100, 0.00763, 36000, b"bench", 0.0, axes, number))


@pytest.mark.parametrize(("number", "name"), [(0, None), (1, "hdr"), (3, "attitude"), (200, "filter 200")])
def test_a_filter_of_a_newer_device_has_a_name_too(number: int, name: str | None) -> None:
    decoder, readings = read(hello(number), sample(0), own_yaw(0))
    assert decoder.device.device_filter == name
    assert readings[0].device_yaw == (OWN if name else None)


def test_three_axes_get_their_yaw() -> None:
    _, (reading,) = read(golden.AXES_FILTER_HELLO, axes_sample_frame(0, 7, 70, (1, 2, 3), (4, 5, 6), 0, 0), own(7, 70))
    assert reading.device_yaw == OWN
    assert reading.inertial is not None


def own(seq: int, t_us: int) -> bytes:
    return yaw_frame(seq, t_us, *OWN)


@pytest.mark.parametrize("hello_frame", [golden.HELLO, golden.AXES_HELLO, hello(0)])
def test_a_device_without_a_filter_has_no_sample_that_waits(hello_frame: bytes) -> None:
    decoder, readings = read(hello_frame, sample(0))
    assert len(readings) == 1
    assert decoder.push(own_yaw(0)) == []
    assert decoder.counters.lone_yaws == 1


def test_yaws_before_hello_are_counted_and_cost_no_sample() -> None:
    """The samples among them wait for HELLO as always."""
    frames = [sample(0), own_yaw(0), sample(1), own_yaw(1), golden.FILTER_HELLO, sample(2), own_yaw(2)]
    decoder, readings = read(*frames)
    assert yaws(readings) == {0: None, 1: None, 2: OWN}
    assert (decoder.counters.lone_yaws, decoder.counters.late, decoder.counters.damaged) == (2, 2, 0)


def test_a_yaw_of_another_sample_is_counted_and_joined_with_none() -> None:
    frames = [sample(1), own_yaw(2), sample(2), own(2, 5), sample(3), own_yaw(3), own_yaw(3), own_yaw(4), sample(5)]
    decoder, readings = read(golden.FILTER_HELLO, *frames, own_yaw(5))
    assert yaws(readings) == {1: None, 2: None, 3: OWN, 5: OWN}
    assert decoder.counters.lone_yaws == 4


def test_a_yaw_before_its_sample_is_counted() -> None:
    decoder, readings = read(golden.FILTER_HELLO, own_yaw(0), sample(0), sample(1), own_yaw(1))
    assert yaws(readings) == {0: None, 1: OWN}
    assert decoder.counters.lone_yaws == 1


@pytest.mark.parametrize(
    "values",
    [
        (nan, 0.1, 0.0),
        (inf, 0.1, 0.0),
        (2.0 * MOST_DEG, 0.1, 0.0),
        (1.0, -0.1, 0.0),
        (1.0, inf, 0.0),
        (1.0, 0.1, nan),
        (1.0, 0.1, -2.0 * MOST_BIAS_DPS),
    ],
)
def test_values_that_no_filter_gives_cost_the_frame(values: tuple[float, float, float]) -> None:
    decoder, readings = read(golden.FILTER_HELLO, sample(0), own_yaw(0, DeviceYaw(*values)), sample(1), own_yaw(1))
    assert yaws(readings) == {0: None, 1: OWN}
    assert (decoder.counters.damaged, decoder.counters.lone_yaws) == (1, 0)


def test_a_filter_without_a_sigma_sends_nan() -> None:
    _, (reading,) = read(hello(1), sample(0), own_yaw(0, DeviceYaw(1.0, nan, 0.0)))
    assert reading.device_yaw is not None
    assert isnan(reading.device_yaw.yaw_sigma_deg)


def test_samples_without_a_yaw_do_not_wait_where_only_every_fifth_has_one() -> None:
    decoder = NativeDecoder()
    decoder.push(golden.FILTER_HELLO)
    waited, joined = [], []
    for seq in range(65520, 65560):
        has_yaw = seq % 5 == 0
        readings = decoder.push(sample(seq))
        waited.append(all(reading.seq != seq % 65536 for reading in readings))
        readings += decoder.push(own_yaw(seq)) if has_yaw else []
        joined += [reading.seq for reading in readings if reading.device_yaw is not None]
    assert joined == [seq % 65536 for seq in range(65520, 65560, 5)]
    assert [index for index, has_waited in enumerate(waited) if has_waited and index > 5] == list(range(10, 40, 5))


def test_yaws_at_uneven_distances_are_all_joined_after_the_shortest_one() -> None:
    """A timer of its own sends them so."""
    with_yaw = {0, 11, 21, 32, 42, 53}
    frames = [sample(seq) + (own_yaw(seq) if seq in with_yaw else b"") for seq in range(60)]
    decoder, readings = read(golden.FILTER_HELLO, *frames)
    joined = {reading.seq for reading in readings if reading.device_yaw is not None}
    assert joined == with_yaw - {21}
    assert decoder.counters.lone_yaws == 1


def test_another_device_without_a_filter_is_taken_as_such() -> None:
    """Samples of one without a filter do not wait, and the last of the one before is not lost."""
    decoder = NativeDecoder()
    assert decoder.push(golden.FILTER_HELLO + sample(0)) == []
    assert [reading.seq for reading in decoder.push(golden.HELLO + sample(1))] == [0, 1]


def test_after_a_reconnect_the_yaws_are_taken_again_from_hello_on() -> None:
    old = NativeDecoder()
    old.push(golden.FILTER_HELLO + sample(0) + own_yaw(0))
    fresh = renewed(PROTOCOLS["native"], old)
    readings = fresh.push(sample(1) + own_yaw(1) + golden.FILTER_HELLO + sample(2) + own_yaw(2))
    assert {reading.seq: reading.device_yaw for reading in readings} == {1: None, 2: OWN}


SENT = [golden.FILTER_HELLO] + [frame for seq in range(12) for frame in (sample(seq), own_yaw(seq))]


@given(st.lists(st.integers(0, len(b"".join(SENT))), max_size=8))
def test_the_readings_do_not_depend_on_the_split(cuts: list[int]) -> None:
    stream, decoder = b"".join(SENT), NativeDecoder()
    ends = [0, *sorted(cuts), len(stream)]
    readings = [reading for start, end in pairwise(ends) for reading in decoder.push(stream[start:end])]
    assert readings == NativeDecoder().push(stream)
    assert all(reading.device_yaw == OWN for reading in readings)


@given(st.lists(st.integers(1, len(SENT) - 1), max_size=40))
def test_loss_repetition_and_disorder_cost_no_sample_and_mix_no_yaw(indices: list[int]) -> None:
    """Every sample that was sent comes out in its order; a yaw belongs to its own sample."""
    yaw_of = [own_yaw(seq, DeviceYaw(float(seq), 0.0, 0.0)) for seq in range(12)]
    frames = [yaw_of[(index - 1) // 2] if index % 2 == 0 else SENT[index] for index in indices]
    _, readings = read(golden.FILTER_HELLO, *frames, sample(99), own_yaw(99))
    assert [reading.seq for reading in readings[:-1]] == [(index - 1) // 2 for index in indices if index % 2]
    for reading in readings[:-1]:
        assert reading.device_yaw is None or reading.device_yaw.yaw_deg == reading.seq
