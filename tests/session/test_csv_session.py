"""Sessions as people have them: any columns in any order, and clear words for what is wrong."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gyrodrift.session.files import load_session, write_session
from gyrodrift.values.errors import DataError


def written(folder: Path, text: str | bytes, name: str = "s.csv") -> Path:
    path = folder / name
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return path


def test_columns_come_in_any_order_and_may_be_absent(tmp_path: Path) -> None:
    """Comments and blank lines are passed over."""
    session = load_session(written(tmp_path, "# mine\n rate_dps , seq,t_device_s\n1,7,0\n# half way\n\n2,8,.5\n"))
    assert session.name == "s"
    assert session.t_device_s.tolist() == [0.0, 0.5]
    assert session.rate_dps.tolist() == [1.0, 2.0]
    assert session.seq is not None
    assert session.seq.tolist() == [7, 8]
    assert (session.encoder_deg, session.temp_c, session.t_host_s) == (None, None, None)


def test_empty_cells_and_nan_are_values_that_are_not_there(tmp_path: Path) -> None:
    text = "\ufefft_device_s,rate_dps,temp_c\r\n0,1,\r\n1,nan,25\r\n2,inf,nan\r\n"
    session = load_session(written(tmp_path, text))
    assert session.temp_c is not None
    assert np.isnan(session.temp_c).tolist() == [True, False, True]
    assert np.isfinite(session.rate_dps).tolist() == [True, False, False]


@given(st.lists(st.tuples(*[st.floats(allow_nan=False, width=64)] * 3), min_size=1, max_size=50))
def test_every_digit_is_read(tmp_path_factory: pytest.TempPathFactory, rows: list[tuple[float, float, float]]) -> None:
    """A float written with all its digits comes back with the same bits."""
    lines = "".join(f"{t!r},{rate!r},{angle!r}\n" for t, rate, angle in rows)
    path = written(tmp_path_factory.mktemp("s"), f"t_device_s,rate_dps,encoder_deg\n{lines}")
    session = load_session(path)
    assert session.encoder_deg is not None
    columns = (session.t_device_s.tolist(), session.rate_dps.tolist(), session.encoder_deg.tolist())
    assert list(zip(*columns, strict=True)) == rows


@pytest.mark.promise("Files of other programs")
@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "s.csv: is empty; expected a header with t_device_s, rate_dps"),
        ("# only words\n", "s.csv: is empty; expected a header"),
        ("t_device_s,rate_dps\n", "s.csv: has a header and no samples"),
        (
            "t_device_s,rate_dp\n0,1\n",
            "s.csv:1: column 2 is 'rate_dp'; did you mean rate_dps? columns are t_device_s, t_host",
        ),
        ("t_device_s,speed\n0,1\n", "s.csv:1: its header does not say which column is the rate and in which unit"),
        ("0,1\n1,2\n", "s.csv: it has no header, so nothing says which column is the rate and in which unit"),
        ("# x\nt_device_s,temp_c\n0,1\n", "s.csv:2: its header does not say which column is the rate"),
        ("t_device_s,rate_dps,rate_dps\n0,1,1\n", "s.csv:1: column rate_dps occurs twice"),
        ("t_device_s,rate_dps\n0,1\n1,fast\n", "s.csv:3: rate_dps is 'fast', expected a number"),
        ("t_device_s,rate_dps\n0,1\n\n1\n", "s.csv:4: has 1 values, the header has 2 columns"),
        ("t_device_s,rate_dps\n0,1,2\n", "rows have 3 values, the header has 2 columns"),
        ("1," * 30_000, "s.csv:1: has 30001 columns, more than 1000: it is no session"),
        (b"\x89MCAP0\r\n\xff\x00\x01", "s.csv: is an MCAP file: name it .mcap"),
        (b"\x89PNG\r\n\x1a\x00\x01\x02", "s.csv: is not text"),
    ],
)
def test_what_is_wrong_is_said_with_its_place(tmp_path: Path, text: str | bytes, message: str) -> None:
    """A table with thousands of columns is refused at once, in one line."""
    with pytest.raises(DataError) as caught:
        load_session(written(tmp_path, text))
    assert message in str(caught.value)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("none.csv", "there is no such session"),
        ("", "it is a folder"),
        ("s.xyz", r"end in \.mcap, \.csv, \.tsv, .*, not \.xyz"),
    ],
)
def test_what_is_no_session_is_named(tmp_path: Path, name: str, message: str) -> None:
    """Missing, a folder, another kind of file."""
    written(tmp_path, "", "s.xyz")
    with pytest.raises(DataError, match=message):
        load_session(tmp_path / name)


@given(st.binary(max_size=300))
def test_any_bytes_are_a_session_or_a_data_error(tmp_path_factory: pytest.TempPathFactory, content: bytes) -> None:
    with pytest.raises(DataError):
        load_session(written(tmp_path_factory.mktemp("any"), b"t_device_s,rate_dps\nx" + content))


@pytest.mark.parametrize("seq", ["1e300", "-1e300", "1e19", "inf", "nan"])
def test_a_counter_beyond_all_that_is_counted_is_none(tmp_path: Path, seq: str) -> None:
    session = load_session(written(tmp_path, f"t_device_s,rate_dps,seq\n0,1,{seq}\n1,1,5\n"))
    assert session.seq is not None
    assert session.seq.tolist() == [-1, 5]


def test_what_is_quoted_of_a_file_is_short_and_no_order_to_a_terminal(tmp_path: Path) -> None:
    """Cells and names of columns may hold anything."""
    for text in ("t_device_s,rate_dps\n0,1\n1," + "x" * 100_000, "\x1b]0;title\x07" * 9000 + "\n0,1\n"):
        with pytest.raises(DataError) as caught:
            load_session(written(tmp_path, text))
        assert len(str(caught.value)) < 1200
        assert "\x1b" not in str(caught.value)


def test_what_was_said_of_rest_goes_through_both_formats(tmp_path: Path) -> None:
    statement = [np.nan, 1.0, 1.0, np.nan, 0.0, 0.0, 1.0, np.nan, np.nan, 1.0]
    rows = [f"{n / 100},0.5,{'' if np.isnan(word) else word}" for n, word in enumerate(statement)]
    source, between, back = tmp_path / "a.csv", tmp_path / "b.mcap", tmp_path / "c.csv"
    source.write_text("\n".join(["t_device_s,rate_dps,still", *rows]) + "\n")
    session = load_session(source)
    write_session(between, [session.part(0, 3), session.part(3, 4), session.part(4, 10)])
    write_session(back, [load_session(between)])
    for path in (source, between, back):
        still = load_session(path).still
        assert still is not None
        np.testing.assert_array_equal(still, statement)
