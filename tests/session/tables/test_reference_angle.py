"""The reference angle of a table: by its label, by --columns, or named in a remark."""

from pathlib import Path

import numpy as np
import pytest

from gyrodrift.columns.spec import columns_of
from gyrodrift.session.files import load_session

ROWS = "0.00{sep}0.5{sep}0\n0.01{sep}0.5{sep}0.1\n0.02{sep}0.5{sep}0.2\n0.03{sep}0.5{sep}0.3\n"


def table(folder: Path, header: str, sep: str = ",") -> Path:
    path = folder / "table.csv"
    path.write_text(f"{header}\n{ROWS.format(sep=sep)}")
    return path


@pytest.mark.parametrize(
    ("header", "deg"),
    [
        ("time (s);gyro_z (deg/s);encoder_deg", 0.3),
        ("time (s);gyro_z (deg/s);encoder (rad)", np.rad2deg(0.3)),
        ("time (s);gyro_z (deg/s);reference angle [deg]", 0.3),
    ],
)
def test_a_reference_with_a_unit_is_read_beside_a_rate(tmp_path: Path, header: str, deg: float) -> None:
    session = load_session(table(tmp_path, header, ";"))
    assert session.encoder_deg is not None
    assert session.encoder_deg[-1] == pytest.approx(deg)


def test_a_yaw_may_be_the_reference_or_the_device_s_own(tmp_path: Path) -> None:
    path = table(tmp_path, "time_s,gyro_z_rad_s,yaw_rad")
    session = load_session(path)
    assert session.encoder_deg is None
    (remark,) = session.remarks
    spec = remark.split("'")[1]
    assert spec == "time_s=t_s, gyro_z_rad_s=rate:rads, yaw_rad=encoder:rad"
    stated = load_session(path, columns_of(spec))
    assert stated.encoder_deg is not None
    assert stated.encoder_deg[-1] == pytest.approx(np.rad2deg(0.3))


def test_the_rate_about_z_of_three_is_the_yaw_rate(tmp_path: Path) -> None:
    path = tmp_path / "table.csv"
    path.write_text("t_device_s,gyro_x_dps,gyro_y_dps,gyro_z_dps,encoder_deg\n0,1,2,3,4\n0.01,1,2,3,4\n0.02,1,2,3,4\n")
    session = load_session(path)
    assert session.rate_dps.tolist() == [3.0, 3.0, 3.0]
    assert session.gyro_dps is not None
    assert session.gyro_dps[0].tolist() == [1.0, 2.0, 3.0]
    assert session.encoder_deg is not None
