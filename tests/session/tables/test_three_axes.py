"""Tables of other programs with six axes: every axis in deg/s and m/s², in a right-handed frame with z up."""

from collections.abc import Callable
from math import degrees, radians
from pathlib import Path

import pytest

from gyrodrift.cli import main
from gyrodrift.columns.spec import columns_of
from gyrodrift.session.checks.examine import examined
from gyrodrift.session.checks.stated import ReadingOptions
from gyrodrift.session.files import load_session
from gyrodrift.session.session import Session

ROWS = 40
G_MPS2 = 9.80665
GYRO_DPS, FORCE_MPS2 = (1.5, -2.5, 3.5), (0.5, -1.0, 9.75)
Row = Callable[[int, float], str]


def table(head: str, row: Row) -> str:
    return head + "".join(f"{row(n, 0.01 * n)}\n" for n in range(ROWS))


def joined(*values: float) -> str:
    return ",".join(map(repr, values))


X, Y, Z = map(radians, GYRO_DPS)
AX, AY, AZ = FORCE_MPS2
SIX_AXES: dict[str, tuple[str, str, Row]] = {
    "EuRoC": (
        "imu0.csv",
        (
            "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
            "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n"
        ),
        lambda _, t: f"{round(1.4e18 + t * 1e9)},{joined(X, Y, Z, AX, AY, AZ)}",
    ),
    "rostopic": (
        "imu.csv",
        "%time,field.header.stamp,"
        + ",".join(f"field.{name}.{axis}" for name in ("angular_velocity", "linear_acceleration") for axis in "xyz")
        + "\n",
        lambda _, t: f"{round(1.6e18 + t * 1e9)},{round(1.6e18 + t * 1e9)},{joined(X, Y, Z, AX, AY, AZ)}",
    ),
    "bagpy": (
        "imu-data.csv",
        (
            "Time,header.stamp.secs,angular_velocity.x,angular_velocity.y,angular_velocity.z,"
            "linear_acceleration.x,linear_acceleration.y,linear_acceleration.z\n"
        ),
        lambda _, t: f"{1.6e9 + t:.6f},1600000000,{joined(X, Y, Z, AX, AY, AZ)}",
    ),
    "PlotJuggler": (
        "plot.csv",
        (
            "__time,/imu/angular_velocity/x,/imu/angular_velocity/y,/imu/angular_velocity/z,"
            "/imu/linear_acceleration/x,/imu/linear_acceleration/y,/imu/linear_acceleration/z\n"
        ),
        lambda _, t: f"{1.6e9 + t:.6f},{joined(X, Y, Z, AX, AY, AZ)}",
    ),
    "Betaflight": (
        "LOG00001.csv",
        (
            '"Product","Blackbox flight data recorder"\n"gyro_scale","0x3d000000"\n"acc_1G","2048"\n'
            '"loopIteration","time","gyroADC[0]","gyroADC[1]","gyroADC[2]","accSmooth[0]","accSmooth[1]","accSmooth[2]"\n'
        ),
        lambda n, t: (
            f"{n},{round(t * 1e6)},48,-80,112,{round(AX / G_MPS2 * 2048)},{round(AY / G_MPS2 * 2048)},"
            f"{round(AZ / G_MPS2 * 2048)}"
        ),
    ),
    "mavlogdump, z down": (
        "imu.csv",
        "timestamp,TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ\n",
        lambda _, t: f"{1.6e9 + t},{t * 1e6:.0f},0,{joined(X, -Y, -Z, AX, -AY, -AZ)}",
    ),
    "ulog2csv, z down": (
        "flight_sensor_combined_0.csv",
        (
            "timestamp,gyro_rad[0],gyro_rad[1],gyro_rad[2],accelerometer_m_s2[0],accelerometer_m_s2[1],"
            "accelerometer_m_s2[2]\n"
        ),
        lambda _, t: f"{t * 1e6:.0f},{joined(X, -Y, -Z, AX, -AY, -AZ)}",
    ),
    "WitMotion": (
        "wit.csv",
        "Time(s),ChipTime(),AccX(g),AccY(g),AccZ(g),AsX(°/s),AsY(°/s),AsZ(°/s)\n",
        lambda _, t: f"12:00:{t:06.3f},{t:.3f},{joined(AX / G_MPS2, AY / G_MPS2, AZ / G_MPS2, *GYRO_DPS)}",
    ),
    "iPhone, whose acceleration is that of gravity": (
        "log.csv",
        (
            "gyroTimestamp_sinceReboot(s),gyroRotationX(rad/s),gyroRotationY(rad/s),gyroRotationZ(rad/s),"
            "accelerometerAccelerationX(G),accelerometerAccelerationY(G),accelerometerAccelerationZ(G)\n"
        ),
        lambda _, t: f"{t:.3f},{joined(X, Y, Z, -AX / G_MPS2, -AY / G_MPS2, -AZ / G_MPS2)}",
    ),
    "Physics Toolbox": (
        "multi.csv",
        "time,gFx,gFy,gFz,wx,wy,wz\n",
        lambda _, t: f"{t:.3f},{joined(AX / G_MPS2, AY / G_MPS2, AZ / G_MPS2, X, Y, Z)}",
    ),
    "labels with units": (
        "mine.csv",
        "t_ms,acc_x [g],acc_y [g],acc_z [g],gyro_x (rad/s),gyro_y (rad/s),gyro_z (rad/s)\n",
        lambda _, t: f"{t * 1000:.0f},{joined(AX / G_MPS2, AY / G_MPS2, AZ / G_MPS2, X, Y, Z)}",
    ),
    "our own lines": (
        "capture.log",
        "",
        lambda n, t: f"{round(t * 1e6)},{joined(1.5, -2.5, 3.5 + 0.001 * (n % 7 - 3), AX, AY, AZ)}",
    ),
}


def read(folder: Path, form: str) -> Session:
    name, head, row = SIX_AXES[form]
    path = folder / name
    path.write_text(table(head, row), encoding="utf-8")
    return load_session(path)


@pytest.mark.parametrize("form", SIX_AXES)
def test_a_known_table_gives_all_axes(tmp_path: Path, form: str) -> None:
    session = read(tmp_path, form)
    assert session.gyro_dps is not None
    assert session.accel_mps2 is not None
    assert session.gyro_dps[20] == pytest.approx(GYRO_DPS, abs=0.004)
    assert session.accel_mps2[20] == pytest.approx(FORCE_MPS2, abs=0.003)
    assert session.rate_dps.tolist() == session.gyro_dps[:, 2].tolist()


@pytest.mark.parametrize("ending", [".csv", ".mcap", ".jsonl"])
def test_convert_keeps_all_axes(tmp_path: Path, ending: str) -> None:
    session = read(tmp_path, "EuRoC")
    out = tmp_path / f"out{ending}"
    assert main(["convert", str(tmp_path / "imu0.csv"), str(out)]) == 0
    copy = load_session(out)
    assert copy.gyro_dps is not None
    assert copy.accel_mps2 is not None
    assert session.gyro_dps is not None
    assert session.accel_mps2 is not None
    assert copy.gyro_dps.tolist() == session.gyro_dps.tolist()
    assert copy.accel_mps2.tolist() == session.accel_mps2.tolist()


def test_columns_of_the_user_give_all_axes_with_their_signs(tmp_path: Path) -> None:
    """Units of labels count where the user states none."""
    path = tmp_path / "mine.txt"
    path.write_text(
        table("t,p (rad/s),q (rad/s),r (rad/s),X,Y,Z\n", lambda _, t: f"{t:.2f},{joined(X, -Y, -Z, 0, 0, -1)}")
    )
    spec = "t=t_s, p (rad/s)=gx, q (rad/s)=gy:-, r (rad/s)=gz:-, X=ax:g, Y=ay:g:-, Z=az:g:-"
    session = load_session(path, columns_of(spec))
    assert session.gyro_dps is not None
    assert session.accel_mps2 is not None
    assert session.gyro_dps[0] == pytest.approx(GYRO_DPS)
    assert session.accel_mps2[0] == pytest.approx((0.0, 0.0, G_MPS2))


def test_a_missing_axis_leaves_a_single_one(tmp_path: Path) -> None:
    path = tmp_path / "mine.csv"
    path.write_text(table("t_ms,gyro_x (deg/s),gyro_z (deg/s)\n", lambda _, t: f"{t * 1000:.0f},1,2.5"))
    session = load_session(path)
    assert session.gyro_dps is None
    assert session.rate_dps[0] == 2.5


def session_with(tmp_path: Path, force: tuple[float, float, float]) -> Session:
    """A table of this program with these numbers as accelerations."""
    path = tmp_path / "own.csv"
    head = "t_device_s,rate_dps,gyro_x_dps,gyro_y_dps,gyro_z_dps,accel_x_mps2,accel_y_mps2,accel_z_mps2\n"
    path.write_text(table(head, lambda n, t: joined(t, 0.1 + 0.01 * (n % 5), 0.0, 0.1, 0.1 + 0.01 * (n % 5), *force)))
    return load_session(path)


@pytest.mark.parametrize(
    ("force", "unit"),
    [
        ((0.0, 0.02, 0.99), "g"),
        ((10.0, -30.0, 1005.0), "mg"),
        ((300.0, 0.0, 16400.0), "lsb/16384"),
        ((0.0, 0.0, 4100.0), "lsb/4096"),
    ],
)
def test_gravity_tells_another_unit_of_acceleration(
    tmp_path: Path, force: tuple[float, float, float], unit: str
) -> None:
    """The option that is named gives m/s²."""
    session = session_with(tmp_path, force)
    (finding,) = examined(session).findings
    assert finding.id == "accel_unit"
    assert not finding.is_error
    assert finding.do == f"use --accel-unit {unit}"
    stated = ReadingOptions(accel_unit=unit)
    corrected = stated.applied(session)
    assert corrected.accel_mps2 is not None
    assert corrected.accel_mps2[0][2] == pytest.approx(G_MPS2, rel=0.03)
    assert examined(corrected, stated).findings == ()


def test_accelerations_without_gravity_are_told(tmp_path: Path) -> None:
    (finding,) = examined(session_with(tmp_path, (0.1, 0.0, -0.1))).findings
    assert finding.id == "accel_gravity"
    assert "gravity is missing" in finding.says


def test_accelerations_in_their_unit_are_no_finding(tmp_path: Path) -> None:
    assert examined(session_with(tmp_path, (0.3, -0.2, 9.6))).findings == ()


def test_info_tells_of_three_axes_and_their_unit(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    session_with(tmp_path, (0.0, 0.0, 1.0))
    assert main(["info", str(tmp_path / "own.csv")]) == 0
    text = capsys.readouterr().out
    assert "three axes, accelerometer" in text
    assert "use --accel-unit g" in text
    assert main(["info", str(tmp_path / "own.csv"), "--accel-unit", "g"]) == 0
    assert "median length 9.807 m/s²" in capsys.readouterr().out


def test_an_unknown_unit_of_acceleration_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    session_with(tmp_path, (0.0, 0.0, 1.0))
    assert main(["info", str(tmp_path / "own.csv"), "--accel-unit", "ms2"]) == 2
    assert "expected mps2, g, mg or lsb/N" in capsys.readouterr().err


def test_flip_turns_a_sensor_that_is_upside_down(tmp_path: Path) -> None:
    session = ReadingOptions(is_flipped=True).applied(session_with(tmp_path, (0.5, 1.0, -9.8)))
    assert session.accel_mps2 is not None
    assert session.gyro_dps is not None
    assert session.accel_mps2[0].tolist() == [0.5, -1.0, 9.8]
    assert session.gyro_dps[0].tolist() == [0.0, -0.1, -0.1]
    assert degrees(radians(session.rate_dps[0])) == pytest.approx(-0.1)
