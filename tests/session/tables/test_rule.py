"""The rule itself: no number of a table becomes a rate unless a label says that it is one, and in which unit."""

from math import degrees
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gyrodrift.columns.spec import columns_of
from gyrodrift.session.files import load_session
from gyrodrift.values.errors import DataError

ROWS = 40
CLOCKS = {"t_s": 1.0, "time (ms)": 1e3, "micros": 1e6, "Timestamp [us]": 1e6, "stamp_ns": 1e9}
"""Labels with what a second is there."""

RATES = {
    "gyro_z (deg/s)": 1.0,
    "wz_rad_s": degrees(1.0),
    "gz [mdps]": 1e-3,
    "Gyroscope z (rad/s)": degrees(1.0),
    "yaw rate (°/s)": 1.0,
    "gz (deg/min)": 1.0 / 60.0,
    "gyroZ_mrad/s": degrees(1e-3),
}
NO_RATES = (
    *("gz", "gyro_z", "rate", "z", "", "gz (lsb)", "gyro z raw", "yaw", "yaw rate", "rate (Hz)", "sample rate (Hz)"),
    *("gz (g)", "az (m/s^2)", "mz (uT)", "temp (°C)", "battery (V)", "gx (deg/s)", "gyro_y_rad_s", "roll rate (deg/s)"),
    *("pitch (deg)", "roll", "heading", "qw", "speed (m/s)", "dt_ms", "count", "gz (%)", "wz (m/s)", "gz_dps_limit"),
)
"""Labels that do not say both."""

rest = st.lists(st.sampled_from(NO_RATES), max_size=5)
numbers = st.floats(-2000.0, 2000.0).map(lambda value: round(value, 3))
delimiters = st.sampled_from([",", ";", "\t"])


def written(folder: Path, labels: list[str], columns: list[list[float]], delimiter: str) -> Path:
    rows = [labels] if labels else []
    rows += [[repr(value) for value in row] for row in zip(*columns, strict=True)]
    path = folder / "s.csv"
    path.write_text("\n".join(delimiter.join(row) for row in rows) + "\n")
    return path


@pytest.mark.promise("Files of other programs")
@given(st.data())
def test_labels_without_a_rate_and_its_unit_give_no_session(
    tmp_path_factory: pytest.TempPathFactory, data: st.DataObject
) -> None:
    """Labels without a rate and its unit give no session."""
    clock, names = data.draw(st.sampled_from(list(CLOCKS))), data.draw(rest)
    columns = [[CLOCKS[clock] * number / 100 for number in range(ROWS)]]
    columns += [data.draw(st.lists(numbers, min_size=ROWS, max_size=ROWS)) for _ in names]
    path = written(tmp_path_factory.mktemp("s"), [clock, *names], columns, data.draw(delimiters))
    with pytest.raises(DataError):
        load_session(path)


@pytest.mark.promise("Files of other programs")
@given(st.data())
def test_numbers_without_labels_give_no_session(tmp_path_factory: pytest.TempPathFactory, data: st.DataObject) -> None:
    """Numbers without labels give no session."""
    clock = data.draw(st.sampled_from([0.01, 10.0, 0.0]))
    columns = [[round(clock * number, 3) for number in range(ROWS)]]
    columns += [data.draw(st.lists(numbers, min_size=ROWS, max_size=ROWS)) for _ in range(data.draw(st.integers(1, 6)))]
    path = written(tmp_path_factory.mktemp("s"), [], columns, data.draw(delimiters))
    with pytest.raises(DataError):
        load_session(path)


@pytest.mark.promise("Files of other programs")
@given(st.data())
def test_a_unit_never_passes_as_another(tmp_path_factory: pytest.TempPathFactory, data: st.DataObject) -> None:
    """No unit in a table is taken for another unit."""
    clock, rate = data.draw(st.sampled_from(list(CLOCKS))), data.draw(st.sampled_from(list(RATES)))
    labels = data.draw(st.permutations([clock, rate, *data.draw(rest)]))
    values = {clock: [round(CLOCKS[clock] * number / 100, 6) for number in range(ROWS)]}
    columns = [values.get(label) or data.draw(st.lists(numbers, min_size=ROWS, max_size=ROWS)) for label in labels]
    path = written(tmp_path_factory.mktemp("s"), labels, columns, data.draw(delimiters))
    session = load_session(path)
    np.testing.assert_allclose(session.rate_dps, np.array(columns[labels.index(rate)]) * RATES[rate])
    np.testing.assert_allclose(session.t_device_s, np.arange(ROWS) / 100, atol=1e-9)


@given(st.lists(numbers, min_size=ROWS, max_size=ROWS), st.sampled_from(["dps", "mdps", "rads", "lsb/131"]))
def test_what_a_person_says_counts(tmp_path_factory: pytest.TempPathFactory, rates: list[float], unit: str) -> None:
    path = written(tmp_path_factory.mktemp("s"), [], [[0.01 * n for n in range(ROWS)], rates], ",")
    factor = {"dps": 1.0, "mdps": 1e-3, "rads": degrees(1.0), "lsb/131": 1.0 / 131.0}[unit]
    session = load_session(path, columns_of(f"t_s, rate:{unit}"))
    np.testing.assert_allclose(session.rate_dps, np.array(rates) * factor, atol=1e-12)
