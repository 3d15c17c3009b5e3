"""Heads of several rows, text as devices print it, JSON of other programs, and files that are no table."""

import gzip
import json
import shlex
import subprocess
import zipfile
from pathlib import Path

import pytest
from tables_support import TURN_DEG, filtered_yaw_deg, table, written

from gyrodrift.cli import main
from gyrodrift.columns.guess import guess
from gyrodrift.session.files import load_session
from gyrodrift.session.tables.layout import layout_of
from gyrodrift.session.tables.plan import verdict_on
from gyrodrift.values.errors import DataError

WITHIN_DEG = 1.0


def row(number: int, t_s: float, rate_dps: float) -> str:
    del number
    return f"{t_s:.3f},0.1,{rate_dps:.4f}"


def labels_of(path: Path) -> tuple[str, ...]:
    return layout_of(path).head.labels


@pytest.mark.promise("Files of other programs")
@pytest.mark.parametrize(
    ("head", "labels"),
    [
        ("time,gx,gz\ns,deg/s,deg/s\n", ("time (s)", "gx (deg/s)", "gz (deg/s)")),
        ("s,deg/s,deg/s\ntime,gx,gz\n", ("time (s)", "gx (deg/s)", "gz (deg/s)")),
        ("time,gx,gz\nCAL,CAL,CAL\nms,deg/s,m/(s^2)\n", ("time (ms)", "gx (deg/s)", "gz (m/s^2)")),
        ("time,gx,gz\nunix time,deg/s,deg/s\n100: obd,calc,calc\n", ("time", "gx (deg/s)", "gz (deg/s)")),
        (",gyro,\ntime,x,z\n", ("time", "gyro x", "gyro z")),
        ("time,x,x\n,gyro,acc\n", ("time", "gyro x", "acc x")),
        ("time;gx;gz\n", ("time", "gx", "gz")),
        ('"sep=,"\n"time","rate, z (dps)","gz"\n', ("time", "rate, z (dps)", "gz")),
        ("Product,Logger\nCount,100\ntime,gx,gz\n", ("time", "gx", "gz")),
        ("starting\ntime,gx,gz\ncalibrated\n", ("time", "gx", "gz")),
    ],
)
def test_names_and_units_are_found_in_heads_of_several_rows(tmp_path: Path, head: str, labels: tuple[str, ...]) -> None:
    """RaceChrono, Shimmer, spreadsheets: rows of units, of sources and of groups, another delimiter."""
    path = written(tmp_path / "s.csv", head + "".join(f"{i}.0,0.1,0.2\n" for i in range(50)))
    assert labels_of(path) == labels


def test_a_preamble_of_pairs_is_no_data_and_may_have_units(tmp_path: Path) -> None:
    """LabVIEW: the last label comments the first row only."""
    head = "Version\t2\nSamples\t100\nY_Unit_Label\tdeg/s\nX0\t0.0\n***End***\nX_Value\tGyro Z\tComment\n"
    path = written(tmp_path / "s.lvm", head + "".join(f"{i}.0\t0.2\n" for i in range(50)))
    layout = layout_of(path)
    assert layout.head.labels == ("X_Value", "Gyro Z (deg/s)")
    assert len(layout.head.rows) == 50


def test_words_that_all_labels_share_name_the_device(tmp_path: Path) -> None:
    names = "\t".join(f"Shimmer_5E1A_{name}_CAL" for name in ("Timestamp_Unix", "Gyro_X", "Gyro_Z"))
    text = table(lambda *sample: row(*sample).replace(",", "\t"), f'"sep=\t"\n{names}\t\ns\tdeg/s\tdeg/s\t\n')
    assert filtered_yaw_deg(written(tmp_path / "s.csv", text)) == pytest.approx(TURN_DEG, abs=WITHIN_DEG)


FORMS = {
    "labels": "t_ms={t:.0f}, gx=0.1, gz={z:.3f} deg/s",
    "colons": "t_ms:{t:.0f} gx:0.10 gz:{z:.3f} dps",
    "arrow": "10:00:{s:06.3f} -> gx:0.1 gz:{z:.3f} dps",
    "log": "[00:00:{s:06.3f},000] <inf> imu: gx 0.1 gz {z:.3f} dps",
    "ESP-IDF": "I ({t:.0f}) imu: gz: {z:.3f} deg/s",
    "elements": '<imu t_ms="{t:.0f}" gz_dps="{z:.3f}"/>',
    "several lines": "t_ms: {t:.0f}\nGyroscope [dps]:\nX = 0.1\nZ = {z:.3f}",
    "pretty JSON": '{{\n  "t_ms": {t:.0f},\n  "gz_dps": {z:.3f}\n}}',
    "JSON in a log": '[10:00:{s:06.3f}] {{"gz_dps": {z:.3f}}}',
    "protobuf": "stamp {{\n  t_ms: {t:.0f}\n}}\nimu {{\n  gz_dps: {z:.3f}\n}}",
    "decimal comma": "t_ms: {t:.0f}; gz: {c} dps",
}
"""Texts that say all that is needed."""


@pytest.mark.promise("Files of other programs")
@pytest.mark.parametrize("form", FORMS.values(), ids=FORMS.keys())
def test_text_captured_from_a_port_is_read_as_at_the_port(tmp_path: Path, form: str) -> None:
    """Labels, prefixes and blocks, with messages between them."""

    def line(number: int, t_s: float, rate_dps: float) -> str:
        message = "battery low\n" if number % 100 == 7 else ""
        shown = f"{rate_dps:.3f}"
        return message + form.format(t=1e3 * t_s, s=t_s, z=rate_dps, c=shown.replace(".", ","))

    path = written(tmp_path / "capture.txt", "MPU6050 ready\n" + table(line))
    assert filtered_yaw_deg(path) == pytest.approx(TURN_DEG, abs=WITHIN_DEG)


OPEN_FORMS = (
    "gx: 0.1{n} gy: 0.2 gz: 0.3",
    "t:{i}00 gx:0.1{n} gz:0.3 dps",
    "#YPRAG=1.{n},2,3,4,5,6,7,8,9",
    "Yaw, Pitch, Roll: 1.{n}, 2.0, 3.0",
    ">gz:{i}0:0.{n}",
    "$TIROT,-30.{n},A",
    "0.{n},0.2,0.3",
    "<0.{n},0.2,0.3>",
    "A gz=0.{n} dps\nB gz=0.{n} dps",
)
"""Texts that leave something open."""


@pytest.mark.parametrize("form", OPEN_FORMS)
def test_what_is_open_is_the_same_for_a_file_and_a_port(tmp_path: Path, form: str) -> None:
    lines = [line for i in range(60) for line in form.format(i=i, n=i % 7).split("\n")]
    guessed = guess(lines)
    verdict = verdict_on(layout_of(written(tmp_path / "s.txt", "\n".join(lines) + "\n")).head)
    assert guessed is not None
    assert verdict.template == guessed.template


def test_rows_after_the_times_of_a_monitor_keep_their_places(tmp_path: Path) -> None:
    """The time of the prefix is the last column, and a header names it `time`."""
    text = "".join(f"10:00:{i * 0.05:06.3f} -> 0.1,{i % 3}.5\n" for i in range(100))
    session = load_session(written(tmp_path / "s.txt", "10:00:00.000 -> gx_dps,gz_dps\n" + text))
    assert session.t_device_s[-1] - session.t_device_s[0] == pytest.approx(99 * 0.05)
    assert main(["info", str(written(tmp_path / "t.txt", text)), "--columns", "_, rate:dps, t_s"]) == 0


def test_a_long_table_says_how_one_of_its_kinds_is_taken(tmp_path: Path) -> None:
    """InfluxDB exports them in blocks; a kind that could be a meaning stands in quotes."""
    rows = "".join(f"{50 * i},{axis},{i % 3}.3\n" for axis in ("gx", "gz") for i in range(40))
    path = written(tmp_path / "s.csv", f"t_ms,_field,_value\n{rows}")
    with pytest.raises(DataError, match=r'of several kinds by _field \(gx, gz\): the entry _field="gx" keeps one'):
        load_session(path)
    assert main(["info", str(path), "--columns", '_field="gz", t_ms=t_ms, _value=rate:dps']) == 0


def test_json_with_names_beside_rows_is_a_table(tmp_path: Path) -> None:
    """Edge Impulse: names, units and an interval; pandas: columns and data."""
    rows = [[0.1, 0.2 + i % 3] for i in range(100)]
    sensors = [{"name": "gyrX", "units": "deg/s"}, {"name": "gyrZ", "units": "deg/s"}]
    content = {"protected": {"ver": "v1"}, "payload": {"interval_ms": 20, "sensors": sensors, "values": rows}}
    session = load_session(written(tmp_path / "s.json", json.dumps(content)))
    assert session.t_device_s[-1] == pytest.approx(99 * 0.02)
    split = {"columns": ["t_s", "gz_dps"], "index": [0, 1, 2, 3], "data": [[0.1 * i, i % 2] for i in range(4)]}
    assert load_session(written(tmp_path / "p.json", json.dumps(split))).rate_dps.tolist() == [0, 1, 0, 1]


def test_objects_over_several_lines_are_read_past_a_damaged_one(tmp_path: Path) -> None:
    objects = [json.dumps({"t_ms": 50 * i, "gz_dps": i % 3}, indent=2) for i in range(40)]
    objects[7] = objects[7][:-9]
    session = load_session(written(tmp_path / "s.json", "\n".join(objects)))
    assert len(session.rate_dps) == 39
    assert "1 bad row is left out" in session.remarks[0]


def test_a_log_of_gyroflow_is_read_with_its_scales(tmp_path: Path) -> None:
    head = "GYROFLOW IMU LOG\ntscale,0.001\ngscale,0.001\nascale,0.0005\nt,gx,gy,gz,ax,ay,az\n"
    path = written(tmp_path / "s.gcsv", head + "".join(f"{10 * i},4,-13,{i % 5},2,-4,2041\n" for i in range(50)))
    session = load_session(path)
    assert session.t_device_s[-1] == pytest.approx(0.49)
    assert session.rate_dps[4] == pytest.approx(0.2292, abs=1e-3)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\n", "is a pointer of Git LFS, no data"),
        (b"\n<!DOCTYPE html>\n<html><body>1,2,3</body></html>", "is a web page, no data"),
        (b"\x89HDF\r\n\x1a\n\0\0", "is an HDF5 file"),
        (b"BZh91AY", "is compressed by bzip2; unpack it: bzip2 -dc"),
        (b"gx:FF83 gz:0041\n" * 9, "its numbers are hexadecimal; let the device print decimal numbers"),
        (b"hello\nworld\n", "has no samples: no rows of numbers"),
    ],
)
def test_a_file_that_is_no_table_is_named(tmp_path: Path, content: bytes, message: str) -> None:
    for ending in (".csv", ".xyz"):
        with pytest.raises(DataError) as caught:
            load_session(written(tmp_path / f"s{ending}", content))
        assert message in str(caught.value)


def test_the_advice_for_packed_files_works(tmp_path: Path) -> None:
    """A free name is proposed, and a spreadsheet is no archive."""
    text = table(row, "time (s),gx (deg/s),gz (deg/s)\n").encode()
    path = written(tmp_path / "my imu.csv.gz", gzip.compress(text))
    written(tmp_path / "my imu.csv", "mine")
    with pytest.raises(DataError) as caught:
        load_session(path)
    command = str(caught.value).partition("unpack it: ")[2]
    subprocess.run(command, shell=True, check=True)
    unpacked = Path(shlex.split(command)[-1])
    assert (tmp_path / "my imu.csv").read_text() == "mine"
    assert filtered_yaw_deg(unpacked) == pytest.approx(TURN_DEG, abs=WITHIN_DEG)
    with zipfile.ZipFile(tmp_path / "s.ods", "w") as archive:
        archive.writestr("mimetype", "application/vnd.oasis.opendocument.spreadsheet")
    with pytest.raises(DataError, match=r"is a spreadsheet: save the sheet as \.csv"):
        load_session(tmp_path / "s.ods")


def test_rows_of_one_kind_may_have_another_width(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    def kinds(number: int, t_s: float, rate_dps: float) -> str:
        force, gyro = f"A,{1e3 * t_s:.0f},0.0,0.1,0.9", f"G,{1e3 * t_s:.0f},0.1,0.2,{rate_dps:.3f},1,2"
        return f"{force}\n{gyro}" + (f"\nB,{1e3 * t_s:.0f},3.9" if number % 10 == 0 else "")

    path = written(tmp_path / "log.csv", table(kinds))
    assert filtered_yaw_deg(path, "--columns", "=G, t_ms, gx, gy, rate") == pytest.approx(TURN_DEG, abs=WITHIN_DEG)
    assert main(["filter", str(path), "--columns", "=B, t_ms, gx, gy, rate"]) == 4
    assert "has 3 values, 5 are named" in capsys.readouterr().err
