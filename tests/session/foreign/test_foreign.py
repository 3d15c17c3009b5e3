"""Sessions in files that others wrote: every kind of file, and the channel that is meant."""

from pathlib import Path

import pytest
from foreign_support import (
    FIELDS,
    FORMS,
    METADATA,
    SAMPLE_TEXT,
    Recorder,
    as_json,
    cdr,
    in_json,
    own,
    refused,
    rows,
    written,
)

from gyrodrift.session.foreign.read import read_foreign
from gyrodrift.values.errors import DataError


@pytest.mark.parametrize("form", FORMS)
def test_samples_come_out_of_every_form_of_file(tmp_path: Path, form: str) -> None:
    """Value by value, with what stands beside them."""
    values = rows(100)
    session = read_foreign(written(tmp_path, own(values, **FORMS[form])))
    for name in FIELDS:
        assert getattr(session, name).tolist() == [row[name] for row in values]
    assert session.name == "s"
    assert session.metadata == METADATA


@pytest.mark.parametrize("form", FORMS)
def test_json_is_understood_in_every_form_of_file(tmp_path: Path, form: str) -> None:
    payloads = [as_json({"t_device_s": i, "rate_dps": -i, "seq": i, "note": "passed over"}) for i in range(50)]
    session = read_foreign(written(tmp_path, in_json(payloads, topic="/x", **FORMS[form])))
    assert session.t_device_s.tolist() == list(range(50))
    assert session.rate_dps.tolist() == [-i for i in range(50)]
    assert session.seq is not None
    assert session.seq.tolist() == list(range(50))


def test_the_topic_is_the_one_given_or_gyro_or_the_only_one(tmp_path: Path) -> None:
    """Channels of other kinds, and such as have no messages, do not count."""
    recorder = Recorder()
    sample = ("gyrodrift/Sample", "ros2msg", SAMPLE_TEXT)
    recorder.add(recorder.channel("/camera", "cdr", ("sensor_msgs/msg/Image", "ros2msg", "uint8[] x")), [b"\0\1\0\0"])
    recorder.channel("/empty", "cdr", sample)
    recorder.add(recorder.channel("/a", "json"), [b'{"t_device_s": 1, "rate_dps": 1}'] * 2)
    assert len(read_foreign(written(tmp_path, recorder.content())).rate_dps) == 2


def test_several_channels_want_a_choice(tmp_path: Path) -> None:
    recorder = Recorder()
    for topic, count in (("/b", 2), ("/a", 3)):
        recorder.add(recorder.channel(topic, "json"), [b'{"t_device_s": 1, "rate_dps": 1}'] * count)
    path = written(tmp_path, recorder.content())
    with pytest.raises(DataError, match="samples may be on /a, /b; choose one with gyrodrift convert --topic"):
        read_foreign(path)
    assert len(read_foreign(path, "/b").rate_dps) == 2
    with pytest.raises(DataError, match=r"has no messages on /c; topics are /a \(no schema, json\), /b"):
        read_foreign(path, "/c")

    recorder = Recorder()
    for topic, count in (("/b", 2), ("/gyro", 3)):
        recorder.add(recorder.channel(topic, "json"), [b'{"t_device_s": 1, "rate_dps": 1}'] * count)
    assert len(read_foreign(written(tmp_path, recorder.content())).rate_dps) == 3


def test_two_writers_on_one_topic_are_one_session(tmp_path: Path) -> None:
    recorder = Recorder()
    recorder.add(recorder.channel("/a", "json"), [as_json({"t_device_s": 0, "rate_dps": 1})])
    recorder.add(recorder.channel("/a", "cdr", ("gyrodrift/msg/Sample", "ros2msg", SAMPLE_TEXT)), map(cdr, rows(2)))
    assert len(read_foreign(written(tmp_path, recorder.content())).rate_dps) == 3


@pytest.mark.parametrize("topic", [None, "/camera"])
def test_what_is_not_understood_is_listed(tmp_path: Path, topic: str | None) -> None:
    recorder = Recorder()
    recorder.add(recorder.channel("/camera", "cdr", ("sensor_msgs/msg/Image", "ros2msg", "uint8[] x")), [b""])
    recorder.add(recorder.channel("/p", "protobuf"), [b""])
    recorder.add(recorder.channel("/idl", "cdr", ("sensor_msgs/msg/Imu", "ros2idl", "")), [b""])
    text = refused(tmp_path, recorder.content(), topic)
    assert text == (
        f"{topic or 'no channel'} holds samples; "
        "expected gyrodrift/Sample or sensor_msgs/msg/Imu (ros2msg, cdr; ros1msg, ros1), "
        "or json with t_device_s and rate_dps; "
        "topics are /camera (sensor_msgs/msg/Image, ros2msg, cdr), "
        "/idl (sensor_msgs/msg/Imu, ros2idl, cdr), /p (no schema, protobuf)"
    )


def test_what_cannot_be_opened_is_told(tmp_path: Path) -> None:
    with pytest.raises(DataError, match="cannot be read: No such file or directory"):
        read_foreign(tmp_path / "none.mcap")
    with pytest.raises(DataError, match="cannot be read: Is a directory"):
        read_foreign(tmp_path)
