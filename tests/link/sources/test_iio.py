"""Source iio: a sysfs tree and device files that follow Documentation/ABI/testing/sysfs-bus-iio."""

import errno
from collections.abc import Iterator
from contextlib import closing
from itertools import count
from math import degrees, isnan, nan
from pathlib import Path
from struct import pack

import pytest
from iio_support import ACCEL_SCALE, GYRO_SCALE, IioChip, IioTree
from sources_support import Events, read_until

from gyrodrift.link.link import Link
from gyrodrift.link.options import LinkOptions
from gyrodrift.link.search import find_gyro
from gyrodrift.link.sources import iio_sysfs
from gyrodrift.link.sources.iio import IioPort, gyros
from gyrodrift.link.sources.iio_buffer import layout_of
from gyrodrift.link.sources.iio_readings import IDENTITY, IioChannel, IioDescription, IioReadings, is_rotation
from gyrodrift.link.sources.registry import source_devices
from gyrodrift.values.errors import LinkError, PortDeniedError, PortMissingError, UsageError
from gyrodrift.values.sample import Reading, Sample

DPS = degrees(GYRO_SCALE)
MS_NS = 1_000_000


def read_scan(types: dict[str, str], scan: bytes, **channels: IioChannel) -> Reading | None:
    """Reading of a scan with these types; channels have the scale of the tests unless they are given."""
    layout = layout_of(types)
    assert layout is not None
    scales = {name: IioChannel(GYRO_SCALE) for name in types} | channels
    return IioReadings(IioDescription("adxrs450", 0.0, IDENTITY, scales)).reading(layout.counts(scan), nan)


@pytest.fixture
def tree(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> IioTree:
    """Folders of a machine without devices."""
    made = IioTree(tmp_path)
    monkeypatch.setattr(iio_sysfs, "IIO_DEVICES", made.devices)
    monkeypatch.setattr(iio_sysfs, "DEVICE_FILES", made.files)
    return made


@pytest.fixture
def chip(tree: IioTree) -> Iterator[IioChip]:
    """A chip with gyro and accelerometer in one device, with a trigger of its own."""
    made = IioChip(tree, 0, "mpu6050", "1-0068", ("anglvel", "accel"))
    made.write("trigger/current_trigger", "")
    tree.trigger(0, "mpu6050-dev0")
    yield made
    made.close()


@pytest.fixture
def pair(tree: IioTree) -> Iterator[tuple[IioChip, IioChip]]:
    """A chip with two devices, and the FIFO of the chip in place of a trigger."""
    gyro = IioChip(tree, 0, "lsm6ds3_gyro", "1-006a", ("anglvel",))
    accel = IioChip(tree, 1, "lsm6ds3_accel", "1-006a", ("accel",))
    yield gyro, accel
    gyro.close()
    accel.close()


def test_scans_of_the_buffer_are_read_with_the_time_of_the_kernel(chip: IioChip) -> None:
    link = Link(LinkOptions("iio:mpu6050"), Events())
    for step in range(200):
        chip.send(10 * MS_NS * step, 1, -2, 300, 0, 10, 981)
    samples = read_until(link, lambda samples: len(samples) == 200)
    link.close()
    assert samples[-1].t_device_s == pytest.approx(1.99)
    assert samples[0].rate_dps == pytest.approx(300 * DPS)
    assert samples[0].inertial == pytest.approx((DPS, -2 * DPS, 300 * DPS, 0.0, 0.1, 9.81))
    assert link.device.device_id == "mpu6050"
    assert link.device.sample_rate_hz == 100.0


def test_the_device_is_set_up_and_stopped(chip: IioChip) -> None:
    """Trigger, clock, channels and buffer; nothing else measures."""
    chip.element("in_magn_x", 9, "le:s16/16>>0")
    chip.write("scan_elements/in_magn_x_en", "1")
    chip.write("buffer/enable", "1")
    link = Link(LinkOptions("iio:mpu6050"), Events())
    assert chip.text("trigger/current_trigger") == "mpu6050-dev0"
    assert chip.text("current_timestamp_clock") == "monotonic"
    assert [chip.text(f"scan_elements/in_{name}_en") for name in ("anglvel_z", "accel_x", "timestamp", "magn_x")] == [
        *("1", "1", "1", "0")
    ]
    assert (chip.text("buffer/enable"), chip.text("buffer/length")) == ("1", "1024")
    link.close()
    assert chip.text("buffer/enable") == "0"


def test_a_sampling_frequency_is_set_by_the_address(chip: IioChip) -> None:
    Link(LinkOptions("iio:mpu6050?rate=200"), Events()).close()
    assert chip.text("sampling_frequency") == "200"


def test_gyro_and_accelerometer_of_one_chip_are_joined_by_time(pair: tuple[IioChip, IioChip]) -> None:
    gyro, accel = pair
    link = Link(LinkOptions("iio:lsm6ds3_gyro"), Events())
    for step in range(50):
        accel.send(10 * MS_NS * step + MS_NS, step, 0, 981)
    for step in range(100):
        gyro.send(10 * MS_NS * step, 0, 0, 5)
    samples = read_until(link, lambda samples: len(samples) == 100)
    link.close()
    forces = [sample.inertial.accel_x_mps2 for sample in samples if sample.inertial is not None]
    assert forces[:50] == pytest.approx([step * ACCEL_SCALE for step in range(50)])
    assert isnan(forces[60])
    assert accel.text("buffer/enable") == "0"


def test_another_accelerometer_of_the_chip_is_polled_with_its_own_scale(pair: tuple[IioChip, IioChip]) -> None:
    with closing(Link(LinkOptions("iio:lsm6ds3_gyro?poll=250"), Events())) as link:
        samples = read_until(link, lambda samples: len(samples) >= 1)
    assert samples[0].inertial == pytest.approx((100 * DPS, 200 * DPS, 300 * DPS, 1.0, 2.0, 3.0))


def test_the_accelerometer_can_be_left_out(pair: tuple[IioChip, IioChip]) -> None:
    link = Link(LinkOptions("iio:lsm6ds3_gyro?accel=none"), Events())
    assert pair[1].text("buffer/enable") == "0"
    link.close()


def test_the_mount_matrix_turns_the_axes(chip: IioChip) -> None:
    """The chip lies on its back: y and z change their sign."""
    chip.write("in_anglvel_mount_matrix", "1, 0, 0; 0, -1, 0; 0, 0, -1")
    link = Link(LinkOptions("iio:mpu6050"), Events())
    chip.send(0, 1, 2, 3, 0, 0, -981)
    (sample,) = read_until(link, lambda samples: len(samples) == 1)
    link.close()
    assert sample.inertial == pytest.approx((DPS, -2 * DPS, -3 * DPS, 0.0, 0.0, 9.81))


@pytest.mark.parametrize("matrix", ["1, 0, 0; 0, 1, 0; 0, 0, -1", "2, 0, 0; 0, 1, 0; 0, 0, 1", "1, 0; 0, 1"])
def test_a_matrix_that_is_no_rotation_is_ignored_and_reported(chip: IioChip, matrix: str) -> None:
    """A mirrored one would change the sign of the yaw rate."""
    chip.write("mount_matrix", matrix)
    events = Events()
    link = Link(LinkOptions("iio:mpu6050"), events)
    chip.send(0, 1, 2, 3, 0, 0, 981)
    (sample,) = read_until(link, lambda samples: len(samples) == 1)
    link.close()
    assert sample.rate_dps == pytest.approx(3 * DPS)
    assert "mount_matrix_ignored" in events.names()


def test_the_temperature_comes_from_sysfs(chip: IioChip) -> None:
    """Offset and scale give thousandths of °C."""
    for name, value in (("raw", "-521"), ("offset", "12421"), ("scale", "2.941176")):
        chip.write(f"in_temp_{name}", value)
    link = Link(LinkOptions("iio:mpu6050"), Events())
    chip.send(0, 1, 2, 3, 0, 0, 981)
    (sample,) = read_until(link, lambda samples: len(samples) == 1)
    link.close()
    assert sample.temp_c == pytest.approx(35.0, abs=0.01)


def test_a_temperature_in_the_scans_is_read(tree: IioTree) -> None:
    types = {"anglvel_z": "le:s16/16>>0", "temp": "be:s16/16>>0", "timestamp": "le:s64/64>>0"}
    reading = read_scan(types, pack("<h", 5) + pack(">h4x", -521) + bytes(8), temp=IioChannel(2.941176, 12421.0))
    assert reading is not None
    assert reading.temp_c == pytest.approx(35.0, abs=0.01)


def test_without_a_trigger_the_values_are_polled(chip: IioChip, tree: IioTree) -> None:
    (tree.devices / "trigger0" / "name").write_text("other\n")
    events = Events()
    link = Link(LinkOptions("iio:mpu6050"), events)
    assert link.fileno() is None
    assert link.wake_s() <= 0.01
    samples = read_until(link, lambda samples: len(samples) >= 20)
    link.close()
    assert samples[0].inertial == pytest.approx((100 * DPS, 200 * DPS, 300 * DPS, 1.0, 2.0, 3.0))
    assert samples[-1].t_device_s > samples[0].t_device_s
    polled = next(fields for event, fields in events.told if event == "iio_polled")
    assert "no trigger; create one in configfs" in polled["reason"]


def test_the_address_can_ask_for_polling(chip: IioChip) -> None:
    with closing(Link(LinkOptions("iio:mpu6050?poll=250"), Events())) as link:
        assert link.wake_s() <= 0.004
        assert len(read_until(link, lambda samples: len(samples) >= 3)) >= 3
    assert chip.text("trigger/current_trigger") == ""


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        ("poll=0", "poll=0 is no number from 1 to 1000"),
        ("poll=x", "poll=x is no number from 1 to 1000"),
        ("poll=00010005", "poll=00010005 is no number from 1 to 1000"),
        ("rate=0", "rate=0 is no number above 0"),
        ("rate=1e400", "rate=1e400 is no number above 0"),
        ("gain=1", "'gain=1' is no option of this source; there are accel=… and rate=…"),
    ],
)
def test_a_wrong_option_is_an_error(chip: IioChip, options: str, expected: str) -> None:
    with pytest.raises(UsageError, match=expected):
        Link(LinkOptions(f"iio:mpu6050?{options}"), Events())


@pytest.mark.parametrize("scale", ["0", "0.000000000", "nan", "-", "1e400", ""])
def test_a_rate_without_a_unit_is_an_error(chip: IioChip, scale: str) -> None:
    """A wrong scale would give an angle that looks right."""
    chip.write("in_anglvel_scale", scale)
    with pytest.raises(LinkError, match=rf"the scale of in_anglvel_x in .* is {scale or 'absent'}, so its unit"):
        Link(LinkOptions("iio:mpu6050"), Events())


def test_a_device_with_a_label_is_found_by_both_names(chip: IioChip) -> None:
    """The device tree may label a chip."""
    chip.write("label", "left-gyro")
    for name in ("left-gyro", "mpu6050", "device0"):
        Link(LinkOptions(f"iio:{name}?poll=10"), Events()).close()
    assert [device.name for device in source_devices() if device.name.startswith("iio:")] == ["iio:left-gyro"]


def test_a_device_without_sampling_frequency_is_an_error(chip: IioChip) -> None:
    (chip.folder / "sampling_frequency").unlink()
    with pytest.raises(UsageError, match=r"mpu6050 has no sampling_frequency in .*; leave out rate="):
        Link(LinkOptions("iio:mpu6050?rate=200"), Events())


def test_a_device_without_a_buffer_is_polled(tree: IioTree, chip: IioChip) -> None:
    chip.pipe.unlink()
    link = Link(LinkOptions("iio:mpu6050"), Events())
    assert read_until(link, lambda samples: len(samples) >= 3)[0].inertial is not None
    link.close()


def test_a_device_that_is_unplugged_is_read_again_when_it_comes_back(chip: IioChip) -> None:
    events = Events()
    link = Link(LinkOptions("iio:mpu6050"), events)
    for step in range(30):
        chip.send(10 * MS_NS * step, 1, -2, 3, 0, 10, 981)
    read_until(link, lambda samples: len(samples) == 30)
    chip.unplug()
    read_until(link, lambda _: link.port is None)
    assert link.read() == []
    chip.plug_in()
    read_until(link, lambda _: link.port is not None)
    now_ns = 10 * MS_NS * 30 + int(0.2 * 1e9)
    for step in range(30):
        chip.send(now_ns + 10 * MS_NS * step, 1, -2, 3, 0, 10, 981)
    assert len(read_until(link, lambda samples: len(samples) >= 29)) >= 29
    link.close()
    assert link.counters.reconnects == 1
    assert link.counters.gaps == 1
    assert "link_restored" in events.names()


def test_devices_of_one_name_are_told_apart_by_their_number(tree: IioTree, chip: IioChip) -> None:
    second = IioChip(tree, 1, "mpu6050", "1-0069", ("anglvel", "accel"))
    with pytest.raises(LinkError, match=r"2 devices are called mpu6050: device0 \(mpu6050 at 1-0068\), device1"):
        Link(LinkOptions("iio:mpu6050"), Events())
    assert [device.name for device in source_devices() if device.name.startswith("iio:")] == [
        *("iio:device0", "iio:device1")
    ]
    Link(LinkOptions("iio:device1"), Events()).close()
    second.close()


def test_gyros_are_listed_by_name(pair: tuple[IioChip, IioChip]) -> None:
    """An accelerometer alone is no gyro."""
    listed = [device for device in source_devices() if device.name.startswith("iio:")]
    assert [(device.name, device.product) for device in listed] == [("iio:lsm6ds3_gyro", "lsm6ds3_gyro")]


def test_port_auto_takes_the_only_gyro(chip: IioChip) -> None:
    for step in range(200):
        chip.send(10 * MS_NS * step, 1, -2, 300, 0, 10, 981)
    events = Events()
    options, port = find_gyro([], LinkOptions("auto"), events, devices=gyros())
    assert (options.port, options.protocol, options.baud) == ("iio:mpu6050", "iio", None)
    with closing(Link(options, events, port=port)) as link:
        steps = count(200)

        def has_samples(samples: list[Sample]) -> bool:
            chip.send(10 * MS_NS * next(steps), 1, -2, 300, 0, 10, 981)
            return len(samples) >= 5

        assert read_until(link, has_samples)[0].rate_dps == pytest.approx(300 * DPS)
        assert link.device.device_id == "mpu6050"
        assert link.counted()["damaged"] == 0
        assert isinstance(link.port, IioPort)
    fields = next(fields for event, fields in events.told if event == "port_found")
    assert fields["rate_hz"] == pytest.approx(100.0, abs=0.2)


def test_an_unknown_device_is_an_error_with_the_known_ones(chip: IioChip) -> None:
    with pytest.raises(PortMissingError, match=r"no IIO gyro 'bmi160'; there is device0 \(mpu6050 at 1-0068\); is its"):
        Link(LinkOptions("iio:bmi160"), Events())


def test_an_unknown_trigger_is_an_error(chip: IioChip) -> None:
    with pytest.raises(UsageError, match="there is no trigger 'x'; there are: mpu6050-dev0"):
        Link(LinkOptions("iio:mpu6050?trigger=x"), Events())


def test_a_refused_permission_names_the_udev_rule() -> None:
    error = iio_sysfs.explained(Path("/dev/iio:device0"), PermissionError(errno.EACCES, "denied"))
    assert isinstance(error, PortDeniedError)
    assert 'SUBSYSTEM=="iio"' in str(error)


def test_a_channel_of_an_unknown_type_is_an_error(chip: IioChip) -> None:
    chip.write("scan_elements/in_anglvel_z_type", "le:f32/32>>0")
    with pytest.raises(LinkError, match=r"its scans cannot be read: .*anglvel_z le:f32/32>>0"):
        Link(LinkOptions("iio:mpu6050"), Events())


@pytest.mark.parametrize(
    ("form", "content", "raw"),
    [
        ("le:s16/16>>0", b"\xfe\xff", -2),
        ("be:s16/16>>0", b"\xff\xfe", -2),
        ("be:u12/16>>4", b"\xff\xf0", 4095),
        ("le:s12/16>>4", b"\xf0\xff", -1),
        ("be:s20/32>>12", b"\x80\x00\x00\x00", -524288),
        ("le:s24/32>>8", b"\x00\x01\x00\x00", 1),
        ("le:u8/8>>0", b"\xff", 255),
    ],
)
def test_each_type_of_the_document_is_read(form: str, content: bytes, raw: int) -> None:
    layout = layout_of({"anglvel_z": form})
    assert layout is not None
    assert layout.counts(content) == {"anglvel_z": raw}
    assert layout.size == len(content)


def test_elements_are_aligned_as_in_the_kernel() -> None:
    forms = ("le:s16/16>>0", "le:s32/32>>0", "le:s16/16>>0", "le:s64/64>>0", "le:s8/8>>0")
    layout = layout_of({str(i): form for i, form in enumerate(forms)})
    assert layout is not None
    assert [element.position for element in layout.elements.values()] == [0, 4, 8, 16, 24]
    assert layout.size == 32


@pytest.mark.parametrize(
    "form", ["", "le:s16/16>>1x", "le:s0/16", "le:s17/16", "le:s16/16>>1", "xe:s16/16", "le:s16/12"]
)
def test_an_impossible_type_has_no_layout(form: str) -> None:
    assert layout_of({"anglvel_z": form}) is None


def test_the_example_of_the_document_is_a_rotation() -> None:
    assert is_rotation((0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0))


def test_a_gyro_with_one_axis_gives_one() -> None:
    reading = read_scan({"anglvel_z": "le:s16/16>>0", "timestamp": "le:s64/64>>0"}, pack("<h6xq", 100, 5_000_000))
    assert reading is not None
    assert (reading.t_us, reading.inertial) == (5000, None)
    assert reading.rate_dps == pytest.approx(100 * DPS)
    description = IioDescription("adxrs450", 0.0, IDENTITY, {"anglvel_z": IioChannel(GYRO_SCALE)})
    assert IioReadings(description).device.axes == 1
