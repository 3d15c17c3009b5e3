"""Labels of a table that name an error, an aim or a bias beside a unit are no rate and no heading."""

from pathlib import Path

import numpy as np
import pytest

from gyrodrift.session.tables.read import read_table
from gyrodrift.values.errors import DataError


def table(folder: Path, head: str) -> Path:
    path = folder / "log.csv"
    rows = [",".join([f"{i / 100:.2f}", *([f"{i % 90}.5"] * head.count(","))]) for i in range(100)]
    path.write_text("\n".join([head, *rows]) + "\n", encoding="utf-8")
    return path


@pytest.mark.promise("Files of other programs")
@pytest.mark.parametrize(
    "head",
    [
        "time_s,heading_error (deg)",
        "time_s,heading_setpoint (deg)",
        "time_s,heading accuracy (deg)",
        "time_s,bearing to waypoint (deg)",
        "time_s,sun azimuth (deg)",
        "time_s,target qw,target qx,target qy,target qz",
        "time_s,Gyro Z (setpoint) (dps)",
        "time_s,Gyro Z (bias) [dps]",
        "time_s,gz*100 (dps)",
        "time_s,10 gz (dps)",
        "rise time (s),gz (dps)",
    ],
)
def test_another_quantity_is_asked_for(tmp_path: Path, head: str) -> None:
    """A label that names a set point, an error or a bias leads to a question."""
    with pytest.raises(DataError, match="does not say which column"):
        read_table(table(tmp_path, head))


def test_a_duration_before_the_clock_is_not_the_clock(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    rows = [f"{7 - i % 5},{i * 10},1.5" for i in range(100)]
    path.write_text("\n".join(["answer time (ms),time (ms),gz (dps)", *rows]) + "\n", encoding="utf-8")
    assert np.ptp(read_table(path).t_device_s) == pytest.approx(0.99)
