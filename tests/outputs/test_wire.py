"""Samples between the service and the process of the outputs."""

from dataclasses import asdict
from math import nan
from struct import Struct

import pytest
from hypothesis import given
from hypothesis import strategies as st
from outputs_support import corrected, tilted, with_own_yaw

from gyrodrift.outputs import wire
from gyrodrift.outputs.status import ServiceStatus
from gyrodrift.values.aid import AidStatus
from gyrodrift.values.sample import Attitude, Corrected, DeviceYaw, Inertial, Sample

number = st.floats(allow_nan=False)
inertial = st.none() | st.builds(Inertial, *[number] * 6)
attitude = st.none() | st.builds(Attitude, *[number] * 11)
device_yaw = st.none() | st.builds(DeviceYaw, *[number] * 3)
sample = st.builds(Sample, st.integers(0, 2**62), *[number] * 6, inertial, device_yaw, st.just(()))
aids = st.none() | st.dictionaries(
    st.text(max_size=9), st.builds(AidStatus, number, st.just(nan), st.just("")), min_size=1
)
batch = st.lists(st.builds(Corrected, sample, *[number] * 10, attitude, *[number] * 4, aids), max_size=5)


@given(batch)
def test_samples_come_out_as_they_went_in(samples: list[Corrected]) -> None:
    message = wire.pack_samples(samples)
    assert wire.unpack_samples(message) == samples
    assert wire.count_samples(message) == len(samples)


def test_axes_of_a_later_sample_are_not_lost() -> None:
    """A filter goes over to three axes in the middle of a batch."""
    level, later = wire.unpack_samples(wire.pack_samples([corrected(0), tilted(1)]))
    assert (level.sample.inertial, level.attitude) == (None, None)
    assert (later.sample.inertial, later.attitude) == (tilted(1).sample.inertial, tilted(1).attitude)


@pytest.mark.promise("Clients of outputs")
def test_one_axis_has_the_short_record() -> None:
    """Samples of one axis keep their short record on the way to the outputs."""
    level = corrected(7)
    message = wire.pack_samples([level])
    assert message == b"S" + Struct("<q19d").pack(*level.sample[:7], *level[1:11], *level[13 : wire.AIDS])


def test_a_missing_acceleration_is_not_missing_axes() -> None:
    rates = Inertial(1.0, 2.0, 3.0)
    level = corrected(0)
    (back,) = wire.unpack_samples(wire.pack_samples([level._replace(sample=level.sample._replace(inertial=rates))]))
    assert back.sample.inertial is not None
    assert back.sample.inertial[:3] == rates[:3]
    assert back.sample.inertial[3] != back.sample.inertial[3]
    assert back.attitude is None


def test_the_longest_batch_fits_into_a_datagram() -> None:
    assert len(wire.pack_samples([with_own_yaw(tilted(0))] * wire.MOST_RECORDS)) < wire.LONGEST_BYTES


def test_the_yaw_of_the_device_and_the_difference_come_out_as_they_went_in() -> None:
    samples = [corrected(0), with_own_yaw(corrected(1)), with_own_yaw(tilted(2)), tilted(3)._replace(heading_deg=1.0)]
    message = wire.pack_samples(samples)
    back = wire.unpack_samples(message)
    assert [str(result.sample) for result in back] == [str(result.sample) for result in samples]
    assert [result.device_difference_deg for result in back[1:3]] == [-0.25, -0.25]
    assert [result.attitude for result in back] == [result.attitude for result in samples]
    assert wire.count_samples(message) == 4


@pytest.mark.parametrize("kind", [wire.EVENT, wire.STATUS])
def test_other_messages_have_no_samples(kind: bytes) -> None:
    assert wire.count_samples(wire.pack_json(kind, asdict(ServiceStatus()))) == 0


def test_unknown_values_stay_unknown() -> None:
    (back,) = wire.unpack_samples(wire.pack_samples([tilted(0)._replace(heading_deg=nan)]))
    assert back.heading_deg != back.heading_deg
    assert back.attitude == tilted(0).attitude
