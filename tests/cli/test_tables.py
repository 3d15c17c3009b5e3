"""Tables of other programs through the real commands: taken by what their header says, or asked for."""

import json
from collections.abc import Callable
from math import cos, radians, sin
from pathlib import Path

import numpy as np
import pytest
from tables_support import TURN_DEG, Row, angles_deg, filtered_yaw_deg, samples, table, written

from gyrodrift.cli import main
from gyrodrift.session.files import load_session

EPOCH_NS = 1_600_000_000_123_456_700


def ns(t_s: float) -> int:
    return EPOCH_NS + round(t_s * 1e9)


def iso(t_s: float) -> str:
    """A time of 2020-09-13, which goes over the minute."""
    whole, part = divmod(round(t_s * 1e6) + 40_000_000, 1_000_000)
    return f"2020-09-13T12:{26 + whole // 60:02d}:{whole % 60:02d}.{part:06d}Z"


BLACKBOX = (
    '"Product","Blackbox flight data recorder"\n"gyro_scale","0x3d000000"\n"looptime","125"\n'
    '"loopIteration","time","gyroADC[0]","gyroADC[1]","gyroADC[2]"\n'
)
"""0x3d000000 is 1/32."""

EXPECTED: dict[str, tuple[str, str, Row]] = {
    "phyphox": (
        "Raw Data.csv",
        '"Time (s)","Gyroscope x (rad/s)","Gyroscope y (rad/s)","Gyroscope z (rad/s)","Absolute (rad/s)"\n',
        lambda n, t, r: f"{t:.9E},1.0E-3,2.0E-3,{radians(r):.9E},3.0E-3",
    ),
    "Sensor Logger": (
        "GyroscopeUncalibrated.csv",
        "time,seconds_elapsed,z,y,x\n",
        lambda n, t, r: f"{ns(t)},{t},{radians(r)},0.1,0.2",
    ),
    "SensorLog": (
        "log.CSV",
        "loggingTime(txt),gyroTimestamp_sinceReboot(s),gyroRotationX(rad/s),gyroRotationY(rad/s),gyroRotationZ(rad/s)\n",
        lambda n, t, r: f"2020-09-13 12:00:00.000 +0200,{t + 5e5:.6f},0.1,0.2,{radians(r):.6f}",
    ),
    "Physics Toolbox": (
        "multi.csv",
        "time,gFx,gFy,gFz,ax,ay,az,wx,wy,wz,\n",
        lambda n, t, r: f"{t:.3f},0.0,0.0,1.0,0.0,0.0,9.8,0.1,0.2,{radians(r):.5f},",
    ),
    "EuRoC": (
        "imu0.csv",
        "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],a_RS_S_x [m s^-2]\n",
        lambda n, t, r: f"{ns(t)},0.1,0.2,{radians(r):.7f},9.81",
    ),
    "rostopic": (
        "imu.txt",
        "%time,field.header.seq,field.header.stamp,field.header.frame_id,field.angular_velocity.z\n",
        lambda n, t, r: f"{ns(t) + 7_000_000 * (n % 3)},{n},{ns(t)},imu,{radians(r):.7f}",
    ),
    "rostopic without stamps": (
        "imu.csv",
        "%time,field.header.seq,field.header.stamp,field.header.frame_id,field.angular_velocity.z\n",
        lambda n, t, r: f"{ns(t)},{n},0,imu,{radians(r):.7f}",
    ),
    "bagpy": (
        "imu-data.csv",
        "Time,header.seq,header.stamp.secs,header.stamp.nsecs,angular_velocity.x,angular_velocity.z\n",
        lambda n, t, r: f"{1.6e9 + t:.9f},{n},1600000000,{n},0.1,{radians(r):.7f}",
    ),
    "PlotJuggler": (
        "plot.csv",
        "__time,/imu/data/angular_velocity/x,/imu/data/angular_velocity/z\n",
        lambda n, t, r: f"{1.6e9 + t:.9f},0.1,{radians(r):.7f}",
    ),
    "blackbox": (
        "LOG00001.csv",
        BLACKBOX,
        lambda n, t, r: f"{32 * n},{12_000_000 + round(t * 1e6)},1,-2,{round(r * 32)}",
    ),
    "blackbox_decode": (
        "LOG00001.01.csv",
        "loopIteration, time (us), gyroADC[0] (deg/s), gyroADC[1] (deg/s), gyroADC[2] (deg/s)\n",
        lambda n, t, r: f"{32 * n}, {round(t * 1e6)}, 1, -2, {r:.3f}",
    ),
    "WitMotion": (
        "wit.tsv",
        "Time(s)\tChipTime()\tAsX(°/s)\tAsZ(°/s)\n",
        lambda n, t, r: f"12:00:{t:06.3f}\t{iso(t)}\t0.1\t{r:.4f}",
    ),
    "mavlogdump": (
        "imu.csv",
        "timestamp,TimeUS,I,GyrX,GyrY,GyrZ,AccX\n",
        lambda n, t, r: f"{1.6e9 + t},{t * 1e6:.0f},0,0.1,0.2,{-radians(r)},0\n{1.6e9 + t},{t * 1e6:.0f},1,0.1,0.2,9,0",
    ),
    "ulog2csv": (
        "flight_sensor_combined_0.csv",
        "timestamp,gyro_rad[0],gyro_rad[1],gyro_rad[2],gyro_integral_dt\n",
        lambda n, t, r: f"{t * 1e6:.0f},0.1,0.2,{-radians(r)},5000",
    ),
    "Sensor Logger, JSON": (
        "all.jsonl",
        "",
        lambda n, t, r: json.dumps(
            {
                "sensor": "Gravity" if n % 3 == 1 else "Gyroscope",
                "time": str(ns(t)),
                "seconds_elapsed": str(t),
                "z": str(radians(r)),
            }
        ),
    ),
    "our own lines": ("capture.log", "", lambda n, t, r: f"{2_000_000 + round(t * 1e6)},{r:.3f}"),
    "our own lines with a header": (
        "capture.csv",
        "t_us,rate_dps,temp_c\n",
        lambda n, t, r: f"{2_000_000 + round(t * 1e6)},{r:.3f},25.1",
    ),
    "our own output": (
        "yaw.jsonl",
        '{"class": "HELLO", "program": "gyrodrift"}\n',
        lambda n, t, r: json.dumps({"seq": n, "t_s": t, "rate_dps": r, "corrected_dps": 0.0, "yaw_deg": 1.0}),
    ),
}


@pytest.mark.promise("Files of other programs")
@pytest.mark.parametrize("form", EXPECTED)
def test_a_known_head_is_read_without_options(tmp_path: Path, form: str) -> None:
    """Tables of known programs are read without options."""
    name, head, row = EXPECTED[form]
    path = written(tmp_path / name, table(row, head))
    assert filtered_yaw_deg(path) == pytest.approx(TURN_DEG, abs=1.0)


LABELLED: dict[str, tuple[str, Row]] = {
    "semicolons and decimal commas": ("Zeit (s);Gyro Z (°/s)\n", lambda n, t, r: f"{t:.3f};{r:.4f}".replace(".", ",")),
    "our names in quotes, with R's row names": (
        '"","t_device_s","rate_dps"\n',
        lambda n, t, r: f'"{n + 1}",{t:.3f},{r:.4f}',
    ),
    "R's write.table": ('"t_device_s" "rate_dps"\n', lambda n, t, r: f'"{n + 1}" {t:.3f} {r:.4f}'),
    "our names, semicolons, decimal commas": (
        "t_device_s;rate_dps\n",
        lambda n, t, r: f"{t:.3f};{r:.4f}".replace(".", ","),
    ),
    "decimal commas in quotes": (
        "time_s,wz_rad_s\n",
        lambda n, t, r: f'"{t:.3f}","{radians(r):.6f}"'.replace(".", ",").replace('","', '"|"').replace("|", ","),
    ),
    "spaces of any number": ("t_ms   gz_dps\n", lambda n, t, r: f"  {t * 1000:.0f}   {r:.4f} "),
    "bars": ("| time (ms) | gyro_z (rad/s) |\n", lambda n, t, r: f"| {t * 1000:.0f} | {radians(r):.6f} |"),
    "a line of units": ("Time,GyroX,GyroZ\n[s],[mdps],[mdps]\n", lambda n, t, r: f"{t:.3f},3,{r * 1000:.1f}"),
    "a preamble": (
        "Logger 4.2\nDevice: BMI270\n\nmicros,ax (g),gz (deg/s)\n",
        lambda n, t, r: f"{t * 1e6:.0f},0.01,{r:.4f}",
    ),
    "ISO 8601": ("timestamp,yaw_rate_rads\n", lambda n, t, r: f"{iso(t)},{radians(r):.6f}"),
    "German dates": (
        "Zeit;Drehrate Z (°/s);GyroZ (°/s)\n",
        lambda n, t, r: f"13.09.2020 12:00:{t:06.3f};x;{r:.4f}".replace(".", ",").replace("13,09,", "13.09."),
    ),
    "milliseconds since 1970": ("timestamp,gz_dps\n", lambda n, t, r: f"{ns(t) // 1_000_000},{r:.4f}"),
    "decimals since 1970": ("time,gz_dps\n", lambda n, t, r: f"{1_600_000_000 + t:.6f},{r:.4f}"),
    "rows of another sensor between": (
        "t_us,gz_dps,ax_g\n",
        lambda n, t, r: f"{t * 1e6:.0f},{r:.4f},\n{t * 1e6 + 10:.0f},,0.98",
    ),
}


@pytest.mark.parametrize("form", LABELLED)
@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "cp1252"])
def test_labels_that_say_rate_and_unit_are_enough(tmp_path: Path, form: str, encoding: str) -> None:
    head, row = LABELLED[form]
    path = written(tmp_path / "log.txt", table(row, head, 0.1).replace("\n", "\r\n").encode(encoding))
    assert filtered_yaw_deg(path) == pytest.approx(TURN_DEG, abs=1.5)


UNCLEAR: dict[str, tuple[str, Row]] = {
    "no header": ("", lambda n, t, r: f"{t:.3f},{r:.4f},0.1"),
    "three axes without labels": ("", lambda n, t, r: f"{t * 1e6:.0f},0.02,-0.01,{r:.4f}"),
    "our own lines with an angle": ("", lambda n, t, r: f"{t * 1e6:.0f},{17.0 + 0.001 * n:.3f}"),
    "our own lines with counts": ("", lambda n, t, r: f"{t * 1e6:.0f},{round(r * 131)}"),
    "no unit": ("time_ms,gyro_z\n", lambda n, t, r: f"{t * 1000:.0f},{r:.4f}"),
    "a clock without unit": ("time,gz_dps\n", lambda n, t, r: f"{t * 1000:.0f},{r:.4f}"),
    "counts": ("t_ms,gz (lsb)\n", lambda n, t, r: f"{t * 1000:.0f},{round(r * 131)}"),
    "a rate in Hz": ("t_ms,rate (Hz)\n", lambda n, t, r: f"{t * 1000:.0f},{r:.4f}"),
    "an acceleration": ("t_ms,gz (mg)\n", lambda n, t, r: f"{t * 1000:.0f},{r:.4f}"),
    "x and y alone": ("t_ms,gyro_x (dps),gyro_y (dps)\n", lambda n, t, r: f"{t * 1000:.0f},{r:.4f},0"),
    "two gyros": ("t_ms,a gz (dps),b gz (dps)\n", lambda n, t, r: f"{t * 1000:.0f},{r:.4f},{r:.4f}"),
    "yaw without unit": ("t_ms,yaw,pitch,roll\n", lambda n, t, r: f"{t * 1000:.0f},{r:.4f},0,0"),
    "another file of Sensor Logger": ("time,seconds_elapsed,z,y,x\n", lambda n, t, r: f"{ns(t)},{t},9.81,0.1,0.2"),
    "blackbox without its scale": (
        "loopIteration,time,gyroADC[0],gyroADC[1],gyroADC[2]\n",
        lambda n, t, r: f"{n},{t * 1e6:.0f},1,2,{r:.0f}",
    ),
}


@pytest.mark.promise("Files of other programs")
@pytest.mark.parametrize("form", UNCLEAR)
@pytest.mark.parametrize("command", ["info", "filter", "doctor"])
def test_what_no_label_says_is_asked_for(
    tmp_path: Path, form: str, command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """A table without a label for rate and unit ends with status 4, and shows its columns."""
    head, row = UNCLEAR[form]
    path = written(tmp_path / "Accelerometer.csv", table(row, head, 0.1))
    assert main([command, str(path)]) == 4
    report = capsys.readouterr()
    assert "column 2" in report.err
    assert "which column is the rate and in which unit" in report.err
    assert "--columns" in report.err
    assert "--columns '" not in report.err or "UNIT" in report.err or form == "yaw without unit"
    assert "yaw_deg" not in report.out


def test_a_level_that_does_not_return_is_asked_for(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    def angle_with_noise(_n: int, t: float, rate: float) -> str:
        return f"{t * 1e6:.0f},{np.clip(30 * (t - 12), 0, 90) + (rate - round(rate / 30) * 30):.3f}"

    path = written(tmp_path / "log.csv", table(angle_with_noise, "", 0.1))
    assert main(["filter", str(path)]) == 4
    report = capsys.readouterr().err
    assert "90.44 at the last: a rate returns to its level; name the columns with --columns" in report


SPECS: dict[str, Row] = {
    "t_ms, _, rate:rads": lambda n, t, r: f"{t * 1000:.0f},7,{radians(r):.6f}",
    "_, t_s, rate:lsb/131:-, temp": lambda n, t, r: f"{n},{t:.3f},{round(-131 * r)},25",
    "t_ns, gx, gy, rate:mdps, ax, ay, az": lambda n, t, r: f"{ns(t)},1,2,{1000 * r:.1f},0.1,0.2,9.8",
    "gyro.2=rate:dps, when=t_us": lambda n, t, r: json.dumps({"when": round(t * 1e6), "gyro": [0.1, 0.2, r]}),
}


@pytest.mark.parametrize("spec", SPECS)
def test_columns_say_what_a_table_does_not(tmp_path: Path, spec: str) -> None:
    path = written(tmp_path / "odd.log", table(SPECS[spec]))
    assert filtered_yaw_deg(path, "--columns", spec) == pytest.approx(TURN_DEG, abs=1.0)


@pytest.mark.parametrize(
    ("spec", "message"),
    [
        ("t_ms, _, _, _, rate:dps", "--columns: s.csv: has 3 columns, and rate is the 5th"),
        ("gz=rate:dps, time=t_ms", "--columns: s.csv: no column, or more than one, is called 'gz'; there are t, a, b"),
        ("_, rate:dps", "--columns: s.csv: no column is the clock: one of t_us, t_ms, t_s, t_ns"),
        ("_, rats", "'rats' is not a column; did you mean"),
    ],
)
def test_columns_that_the_table_does_not_have_are_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, spec: str, message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    written(tmp_path / "s.csv", "t,a,b\n0,1,2\n1,1,2\n")
    assert main(["info", "s.csv", "--columns", spec]) == 2
    assert message in capsys.readouterr().err


@pytest.mark.parametrize(
    ("label", "spec", "sign"),
    [
        ("yaw (deg)", None, 1.0),
        ("heading [rad]", None, -1.0),
        ("angle", "t_s, yaw:deg:-", -1.0),
        ("angle", "t_s, yaw", 1.0),
    ],
)
def test_an_angle_alone_becomes_a_rate_and_that_is_said(
    tmp_path: Path, label: str, spec: str | None, sign: float, capsys: pytest.CaptureFixture[str]
) -> None:
    scale = radians(1.0) if "rad" in label else 1.0
    rows = [f"{number / 20:.2f},{sign * scale * yaw:.6f}" for number, yaw in enumerate(angles_deg())]
    path = written(tmp_path / "yaw.csv", "\n".join([f"t_s,{label}", *rows]) + "\n")
    options = () if spec is None else ("--columns", spec)
    assert filtered_yaw_deg(path, *options) == pytest.approx(TURN_DEG, abs=1.0)
    assert "its rate is the difference of an angle" in capsys.readouterr().err


@pytest.mark.parametrize("labels", ["qw,qx,qy,qz", "Quat_x,Quat_y,Quat_z,Quat_w", "imu.q.w,imu.q.x,imu.q.y,imu.q.z"])
def test_a_quaternion_alone_becomes_a_rate(tmp_path: Path, labels: str, capsys: pytest.CaptureFixture[str]) -> None:
    rows = []
    for number, yaw in enumerate(angles_deg()):
        parts = {"w": cos(radians(yaw) / 2), "x": 0.0, "y": 0.0, "z": sin(radians(yaw) / 2)}
        rows.append(f"{number / 20:.2f},{','.join(f'{parts[label[-1]]:.7f}' for label in labels.split(','))}")
    path = written(tmp_path / "q.csv", "\n".join([f"t_s,{labels}", *rows]) + "\n")
    assert filtered_yaw_deg(path) == pytest.approx(TURN_DEG, abs=1.0)
    assert "its rate is the difference of the yaw" in capsys.readouterr().err


Change = Callable[[list[str]], list[str]]
DAMAGED: dict[str, tuple[Change, str]] = {
    "torn": (lambda lines: [*lines[:-1], lines[-1][:5]], "1 bad row is left out; line 601 has 1 values"),
    "zeros": (lambda lines: [*lines, "\0" * 5000], "1 bad row is left out; line 602 has zero bytes"),
    "zeros in a row": (lambda lines: [*lines, "1.0,0." + "\0" * 50], "line 602 has zero bytes"),
    "header again": (lambda lines: [*lines[:300], lines[0], *lines[300:]], "1 repeated header is skipped"),
    "junk": (lambda lines: [*lines[:9], "brown-out", "1,2,3,4,5", *lines[9:]], "2 bad rows are left out; line 10 has"),
    "no number": (lambda lines: [*lines[:9], "0.4,oops", *lines[9:]], "line 10 rate_dps is 'oops', expected a number"),
    "a quote": (lambda lines: [*lines[:9], '0.4,"0.4', *lines[9:]], ""),
}


@pytest.mark.promise("Files of other programs")
@pytest.mark.parametrize("damage", DAMAGED)
@pytest.mark.parametrize("head", ["t_device_s,rate_dps", "t_s,gz (deg/s)"])
def test_good_rows_are_kept_and_bad_ones_counted_and_named(
    tmp_path: Path, damage: str, head: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """Good rows of a damaged table are kept; bad rows are counted, and the first is named."""
    change, message = DAMAGED[damage]
    lines = [head, *(f"{t:.3f},{rate:.4f}" for _, t, rate in samples())]
    path = written(tmp_path / "s.csv", "\n".join(change(lines)))
    message = message.replace("rate_dps", head.split(",")[1])
    assert filtered_yaw_deg(path) == pytest.approx(TURN_DEG, abs=1.0)
    assert message in capsys.readouterr().err
    assert main(["info", str(path)]) == 0
    report = capsys.readouterr()
    assert message in report.err
    assert message[:30] in report.out


@pytest.mark.promise("Files of other programs")
def test_nanoseconds_since_1970_lose_nothing(tmp_path: Path) -> None:
    """Nanoseconds since 1970 keep all digits."""
    stamps = [EPOCH_NS + step for step in (0, 1, 4_999_999, 5_000_001)]
    whole = "".join(f"{stamp},0.5\n" for stamp in stamps)
    decimal = "".join(f"{stamp // 10**9}.{stamp % 10**9:09d},0.5\n" for stamp in stamps)
    for unit, rows in (("ns", whole), ("s", decimal)):
        path = written(tmp_path / "s.csv", f"stamp ({unit}),gz (dps)\n{rows}")
        session = load_session(path)
        assert session.t_device_s.tolist() == pytest.approx([0.0, 1e-9, 4.999999e-3, 5.000001e-3], abs=1e-15)


def test_a_session_says_how_it_was_read(tmp_path: Path) -> None:
    name, head, row = EXPECTED["EuRoC"]
    path, out = written(tmp_path / name, table(row, head)), tmp_path / "out.mcap"
    assert main(["convert", str(path), str(out)]) == 0
    kept = load_session(out).metadata["table"]
    assert kept == {"form": "EuRoC", "separated by": "commas", "first stamp": str(EPOCH_NS)}


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"PK\x03\x04" + bytes(range(200)), "is a zip archive"),
        (b"\x1f\x8b\x08" + bytes(range(200)), "is compressed by gzip"),
        (bytes(range(1, 250)) * 9, "is not text"),
        (b"\0" * 5000, "is empty"),
        (b"hello\nworld\n", "has no samples: no rows of numbers"),
        (b'{"a": 1}\n', "which column is the rate"),
        (b"[1, 2]", "has a header and no samples"),
    ],
)
def test_what_is_no_table_is_said_in_a_line(
    tmp_path: Path, content: bytes, message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    path = written(tmp_path / "s.txt", content)
    assert main(["info", str(path)]) == 4
    report = capsys.readouterr().err
    assert "Traceback" not in report
    assert message in report
