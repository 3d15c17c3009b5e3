"""Sessions written: every digit, in any number of pieces."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gyrodrift.session.csv import csv_pieces
from gyrodrift.session.files import load_session
from gyrodrift.session.session import Session
from gyrodrift.values.arrays import Floats

any_float = st.floats(width=64)
times = st.one_of(st.floats(0, 1e7), st.integers(0, 10**13).map(lambda micros: micros / 1e6))
rows = st.lists(st.tuples(times, any_float, any_float, st.integers(-1, 10**12)), min_size=1, max_size=60)


def column(values: list[tuple[float, float, float, int]], index: int) -> Floats:
    return np.array([row[index] for row in values], dtype=np.float64)


def session_of(values: list[tuple[float, float, float, int]]) -> Session:
    seq = np.array([row[3] for row in values])
    return Session("s", column(values, 0), column(values, 1), seq=seq, encoder_deg=column(values, 2))


@given(rows, st.integers(1, 60))
def test_what_is_written_is_read_again_with_the_same_bits(
    tmp_path_factory: pytest.TempPathFactory, values: list[tuple[float, float, float, int]], cut: int
) -> None:
    """NaN, infinities and missing counters included."""
    path: Path = tmp_path_factory.mktemp("s") / "s.csv"
    chunks = [session_of(part) for part in (values[:cut], values[cut:]) if part]
    path.write_text("".join(csv_pieces(chunks)))
    read, whole = load_session(path), session_of(values)
    assert read.seq is not None
    assert read.encoder_deg is not None
    assert np.array_equal(read.t_device_s, whole.t_device_s)
    assert np.array_equal(read.rate_dps, whole.rate_dps, equal_nan=True)
    assert np.array_equal(read.encoder_deg, column(values, 2), equal_nan=True)
    assert read.seq.tolist() == [row[3] for row in values]
    assert read.temp_c is None


@pytest.mark.parametrize("t_s", [9.2e12, 1e13, 1e19, 1e300])
def test_times_beyond_all_clocks_stay_what_they_are(t_s: float) -> None:
    chunk = Session("s", np.array([t_s, 2.0 * t_s]), np.array([0.1, 0.2]))
    assert list(csv_pieces([chunk])) == ["t_device_s,rate_dps\n", f"{t_s!r},0.1\n{2.0 * t_s!r},0.2\n"]
