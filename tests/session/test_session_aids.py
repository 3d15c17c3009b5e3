"""Measurements of second sources in files: what a table says is what every format keeps."""

from math import nan
from pathlib import Path

import numpy as np
import pytest

from gyrodrift.columns.spec import columns_of
from gyrodrift.session.aids import aids_in, aids_text
from gyrodrift.session.files import load_session, write_session
from gyrodrift.session.follow import SampleStream
from gyrodrift.session.foreign.export import write_json
from gyrodrift.session.session import Session, session_of
from gyrodrift.values.aid import Aid
from gyrodrift.values.errors import DataError

SPEC = "t_s=t_s, gz=rate:dps, course=heading:compass:late/0.1, v=speed:kn, l=wheel_left, r=wheel_right, still=rest"


@pytest.fixture
def table(tmp_path: Path) -> Session:
    path = tmp_path / "table.csv"
    rows = [f"{0.01 * i:.2f},{0.5 + 0.01 * (i % 7):.2f},{i if i % 50 == 0 else ''},,{i},{i + 1},1" for i in range(200)]
    path.write_text("\n".join(["t_s,gz,course,v,l,r,still", *rows]) + "\n")
    return load_session(path, columns_of(SPEC))


def without_nan(session: Session) -> list[str]:
    """Measurements as text; those without a time have that of their sample."""
    assert session.aids is not None
    times = session.t_device_s.tolist()
    return [str((row, aid._replace(t_s=times[row]) if np.isnan(aid.t_s) else aid)) for row, aid in session.aids]


def test_every_format_keeps_them(table: Session, tmp_path: Path) -> None:
    first, *others = [aid for _, aid in table.aids or () if aid.kind == "heading"]
    assert (first.name, first.value) == ("course", 0.0)
    assert first.t_s == pytest.approx(-0.1)
    assert [aid.value for aid in others] == [-50.0, -100.0, -150.0]
    for name in ("a.mcap", "a.csv"):
        write_session(tmp_path / name, [table.part(0, 77), table.part(77, 200)])
    write_json(tmp_path / "json.mcap", [table])
    for name in ("a.mcap", "a.csv", "json.mcap"):
        assert without_nan(load_session(tmp_path / name)) == without_nan(table)


def test_a_reader_that_follows_the_file_gets_them_with_their_samples(table: Session, tmp_path: Path) -> None:
    """A recording as a source gives the same samples as a live stream."""
    path = tmp_path / "a.mcap"
    write_session(path, [table])
    stream = SampleStream("a")
    samples = stream.push(path.read_bytes())
    assert samples[0].aids[0].t_s == pytest.approx(-0.1)
    followed = session_of("a", samples)
    assert without_nan(followed) == without_nan(table)


def test_a_row_may_have_a_second_source_alone(tmp_path: Path) -> None:
    """It keeps its time, and comes with the next sample."""
    path = tmp_path / "rows.csv"
    rows = [
        f"{0.01 * i:.3f},{0.5 + 0.01 * (i % 7):.2f}," + (f"\n{0.01 * i + 0.005:.3f},,{i}" * (i % 10 == 0))
        for i in range(50)
    ]
    path.write_text("\n".join(["t_s,gz,course", *rows]) + "\n")
    session = load_session(path, columns_of("t_s=t_s, gz=rate:dps, course=heading"))
    assert len(session.rate_dps) == 50
    assert np.array([(row, aid.t_s, aid.value) for row, aid in session.aids or ()][1:3]) == pytest.approx(
        np.array([(11, 0.105, 10.0), (21, 0.205, 20.0)])
    )


def test_other_times_and_left_out_samples_move_them(table: Session) -> None:
    later = table.timed(table.t_device_s + 5.0).rows(np.array([0, 40, 60, 199]))
    headings = [(row, aid.t_s) for row, aid in later.aids or () if aid.kind == "heading"]
    assert np.array(headings) == pytest.approx(np.array([(0, 4.9), (2, 5.4), (3, 5.9), (3, 6.4)]))


def test_a_name_may_have_any_characters_and_a_wrong_cell_is_told(tmp_path: Path) -> None:
    aids = (Aid('a, "b" | c', "heading", 1.5, 2.0, nan, 90.0), Aid("x", "standing", 1.0))
    assert str(aids_in(aids_text(aids))) == str(aids)
    path = tmp_path / "wrong.csv"
    path.write_text("t_device_s,rate_dps,aids\n0,1,\n0.01,1,course turned 3\n")
    with pytest.raises(DataError, match="sample 2: aids is no measurement"):
        load_session(path)
