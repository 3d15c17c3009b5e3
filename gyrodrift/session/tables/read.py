"""Sessions from tables of other programs, and from tables of this program that another one has saved."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from math import isnan
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gyrodrift.columns.aids import AidColumns
from gyrodrift.columns.names import kind_of
from gyrodrift.columns.spec import SELECTED, Column, quoted
from gyrodrift.columns.times import AS_READ, StatedClock, unit_of_clock
from gyrodrift.columns.units import Dimension, unit_in
from gyrodrift.session.aids import RowAids
from gyrodrift.session.csv import counter, read_exact
from gyrodrift.session.session import ACCEL_COLUMNS, COLUMNS, TABLE, Session, session_of_columns
from gyrodrift.session.tables.clocks import clock_problem, paced, rates_of_deltas
from gyrodrift.session.tables.json_table import is_json, json_head, json_objects, json_rows
from gyrodrift.session.tables.layout import layout_of
from gyrodrift.session.tables.parquet import parquet_head, parquet_rows
from gyrodrift.session.tables.plan import (
    OWN,
    Head,
    TableColumns,
    UsedColumn,
    columns_by_spec,
    is_newest_first,
    known_columns,
    labelled_columns,
    own_columns,
    spec_of,
    verdict_on,
)
from gyrodrift.session.tables.question import check_header, unclear
from gyrodrift.session.tables.rows import VALUES_SHOWN, ColumnsRead, RowReader
from gyrodrift.session.tables.text import Lines, opened
from gyrodrift.session.tables.wire import wire_columns
from gyrodrift.values.arrays import Floats
from gyrodrift.values.constants import FULL_TURN_DEG
from gyrodrift.values.errors import DataError, visible
from gyrodrift.values.quaternion import yaw_parts

CLOCK, PARQUET = "t_device_s", ".parquet"
BAD_SHARE = 0.1
"""A larger share of bad rows means that the table is misread."""

NORMS = (0.9, 1.1)
"""Norms of a unit quaternion after rounding."""

SCALAR_LAST, Y_UP, X_UP = (3, 0, 1, 2), (0, 3, 1, 2), (0, 2, 3, 1)
"""Parts of a quaternion, as they are read, that are w, x, y and z in another convention."""

LEAST_PATH_DEG, AXIS_SHARE, AXIS_STEPS = 30.0, 0.2, 400
"""A device turns about the axis of the longest path; another path with less than this share of it is noise and tilt.

The path is that of this number of steps, so that noise does not count.
"""

MOST_DEG = 1e9
"""Largest angle counted over many turns; larger values are skipped."""


def read_table(path: Path, columns: Sequence[Column] | None = None, clock: StatedClock = AS_READ) -> Session:
    """Load a table.

    Parameters
    ----------
    path
        The file.
    columns
        Meaning of its columns; without them the header has to state it.
    clock
        Unit of its clock, or a sample rate in place of one.

    Raises
    ------
    DataError
        It is no table, does not say which column is the rate and in which unit, or has too many bad rows.
    UsageError
        It does not have the given columns.
    """
    if path.suffix.lower() == PARQUET:
        head = parquet_head(path)
        used = _columns(head, columns, clock).read_indices
        return _read(head, columns, parquet_rows(path, used), PARQUET, clock)
    if columns is None and (session := read_exact(path)) is not None:
        return session
    if is_json(path):
        head = json_head(path)
        objects = ((line, row) for line, values in json_objects(path) for row in json_rows([values], head.labels))
        return _read(head, columns, objects, "JSON", clock)
    layout = layout_of(path, is_by_position=columns is not None and not columns[0].label)
    with opened(path) as file:
        rows = layout.rows(Lines(file, has_comments=layout.has_comments))
        return _read(layout.head, columns, rows, str(layout), clock, has_decimal_comma=layout.has_decimal_comma)


def _read(
    head: Head,
    columns: Sequence[Column] | None,
    rows: Iterable[tuple[int, list[str]]],
    dialect: str,
    clock: StatedClock,
    *,
    has_decimal_comma: bool = False,
) -> Session:
    is_reversed = is_newest_first(head, columns)
    if is_reversed:
        head, rows = replace(head, rows=head.rows[::-1]), reversed(list(rows))
    table_columns = _columns(head, columns, clock)
    if is_reversed:
        remark = "its newest row comes first, so its rows are read from the last to the first"
        table_columns = replace(table_columns, remarks=(*table_columns.remarks, remark))
    keeps_empty = table_columns.form == OWN and dialect != "JSON"
    reader = RowReader(head, table_columns, has_decimal_comma=has_decimal_comma, keeps_empty=keeps_empty)
    return _session(head, table_columns, reader.read(rows), dialect, clock)


def _columns(head: Head, columns: Sequence[Column] | None, clock: StatedClock) -> TableColumns:
    if columns is None or columns[0].label:
        check_header(head)
    if columns is not None:
        table_columns = columns_by_spec(head, columns, needs_clock=not clock.sample_rate_hz)
    else:
        table_columns = own_columns(head) or known_columns(head) or _judged_columns(head, clock)
    if table_columns.form == OWN or clock == AS_READ:
        return table_columns
    used = [replace(column, unit=clock.entry(column.unit)) if column.unit else column for column in table_columns.used]
    if clock.sample_rate_hz:
        used = [column for column in used if column.target != CLOCK]
    return replace(table_columns, used=tuple(used))


def _judged_columns(head: Head, clock: StatedClock) -> TableColumns:
    verdict = verdict_on(head)
    table_columns = labelled_columns(head, verdict, needs_clock=not clock.sample_rate_hz) or wire_columns(head)
    if table_columns is None:
        raise unclear(head, verdict)
    return table_columns


def _session(head: Head, table_columns: TableColumns, read: ColumnsRead, dialect: str, clock: StatedClock) -> Session:
    refused = read.refused
    source = f"{head.path}:{refused.line}"
    if not read.count and read.rejected:
        selected = " and ".join(f"{_label(head, index)} = {value}" for index, value in table_columns.where)
        raise DataError(f"{head.path}: no row has {selected}; there are {', '.join(map(visible, read.rejected))}")
    if not read.count and not refused.count:
        raise DataError(f"{head.path}: has a header and no samples")
    is_torn = refused.count == 1 and refused.is_last and read.count > 0 and _is_torn(head.path)
    if refused.count and not is_torn and refused.count > BAD_SHARE * (read.count + refused.count):
        total = f"; {refused.count} of {read.count + refused.count} rows are bad" if refused.count > 1 else ""
        raise DataError(f"{source}: {refused.why}{total}")
    _check_clock(head, table_columns, read, clock)
    remarks = (*table_columns.remarks, *_remarks(read))
    clocks = _clocks(table_columns)
    return replace(
        _arrays(head, table_columns, read, clock.sample_rate_hz),
        metadata=_kept(table_columns, read, dialect, remarks),
        remarks=remarks,
        rate_scale=_scale(table_columns, "rate_dps", "delta_deg"),
        accel_scale=_scale(table_columns, *ACCEL_COLUMNS),
        time_unit=unit_of_clock(clocks[0].unit) if clocks else "s",
    )


def _scale(table_columns: TableColumns, *targets: str) -> float:
    """Size of the scale of the first of some columns; 1 without them, or for a scale of 0."""
    return next((abs(column.scale) for column in table_columns.used if column.target in targets), 1.0) or 1.0


def _clocks(table_columns: TableColumns) -> list[UsedColumn]:
    """Columns of the clock; the one to which the others are added comes first."""
    clocks = [column for column in table_columns.used if column.unit]
    return sorted(clocks, key=lambda column: column.unit.startswith("+"))


def _label(head: Head, index: int) -> str:
    return visible(head.labels[index].strip()) if index < len(head.labels) else f"column {index + 1}"


def _check_clock(head: Head, table_columns: TableColumns, read: ColumnsRead, stated: StatedClock) -> None:
    """Check that a column is a clock as it is read, unless its label or the user says so.

    Raises
    ------
    DataError
        It is a counter, or is written in another way.
    """
    t_s, clocks = read.column(CLOCK), _clocks(table_columns)
    if table_columns.form == OWN or stated.unit or t_s is None or not clocks:
        return
    clock = clocks[0]
    _check_blocks(head, table_columns, read)
    label = head.labels[clock.index] if clock.index < len(head.labels) else ""
    if read.counted:
        why = f"has no leading zeros in its fraction (%ld.%ld): state --time-unit {read.counted}"
        raise DataError(f"{head.path}: {_label(head, clock.index)} {why}")
    unit = unit_in(label)
    is_said = clock.unit.startswith("d") or (unit is not None and unit.dimension is Dimension.TIME) or len(clocks) > 1
    is_labeled = kind_of(label) == "clock"
    problem = "" if is_said else clock_problem(t_s, unit_of_clock(clock.unit), is_labeled=is_labeled)
    if problem:
        raise DataError(f"{head.path}: {_label(head, clock.index)} {problem}")


def _check_blocks(head: Head, table_columns: TableColumns, read: ColumnsRead) -> None:
    """Check that no column names senders, or runs, whose rows follow each other.

    Raises
    ------
    DataError
        A column has another value wherever the clock goes back, and the same value up to there.
    """
    starts, ends = read.edges[::2], read.edges[1::2]
    used = {column.index for column in table_columns.used} | {index for index, _ in table_columns.where}
    for index in set(range(min(map(len, read.edges)))) - used if len(starts) > 1 else ():
        names = [row[index].strip() for row in starts]
        is_one = names == [row[index].strip() for row in ends] and len(set(head.texts(index))) <= len(names)
        label = head.labels[index] if head.labels else ""
        is_quantity = kind_of(label) not in {"", "seq"} or unit_in(label) is not None or "." in "".join(names)
        if is_one and not is_quantity and all(names) and len(set(names)) == len(names):
            shown = ", ".join(map(visible, names[:VALUES_SHOWN]))
            value = quoted(names[0]) if head.labels else f"{SELECTED}{names[0]}"
            spec = spec_of(head, table_columns, {index: value})
            raise DataError(
                f"{head.path}: its times start again where {_label(head, index)} changes ({shown}), so its rows are"
                f" recordings one after the other: --columns '{spec}' reads the first of them"
            )


def _is_torn(path: Path) -> bool:
    """Whether a file ends within a line, or in zeros, as after a power cut."""
    with path.open("rb") as file:
        file.seek(-min(2, path.stat().st_size), 2)
        end = file.read()
    return not set(end) & set(b"\r\n")


def _remarks(read: ColumnsRead) -> Iterator[str]:
    refused = read.refused
    if refused.count:
        rows = "1 bad row is" if refused.count == 1 else f"{refused.count} bad rows are"
        yield f"{rows} left out; line {refused.line} {refused.why}"
    if read.headers:
        yield f"{'1 repeated header is' if read.headers == 1 else f'{read.headers} repeated headers are'} skipped"
    if read.without_rate:
        yield f"{read.without_rate} rows have no rate and are skipped"


def _kept(
    table_columns: TableColumns, read: ColumnsRead, dialect: str, remarks: Sequence[str]
) -> dict[str, dict[str, str]]:
    """How the table was read; empty for a session of this program without remarks."""
    if table_columns.form == OWN and not remarks:
        return {}
    table = {
        "form": table_columns.form,
        "separated by": dialect,
        "first stamp": read.began,
        "remarks": "; ".join(remarks),
    }
    return {TABLE: {name: text for name, text in table.items() if text}}


def _arrays(head: Head, table_columns: TableColumns, read: ColumnsRead, sample_rate_hz: float) -> Session:
    name = head.path.stem
    columns: dict[str, NDArray[Any] | None] = {column: read.column(column) for column in COLUMNS}
    if columns["seq"] is not None:
        columns["seq"] = counter(columns["seq"])
    if sample_rate_hz:
        columns[CLOCK] = paced(read.count, columns["seq"], sample_rate_hz)
    t_s, yaw_deg, delta_deg = columns[CLOCK], read.column("yaw_deg"), read.column("delta_deg")
    if t_s is None:
        raise DataError(f"{name}: has no clock")
    parts = [column for part in "wxyz" if (column := read.column(f"q{part}")) is not None]
    if len(parts) == 4:
        yaw_deg = _yaws(name, *parts)
        _check_axis(head, table_columns, parts)
    aids = _row_aids(table_columns, read, t_s) if table_columns.aids else None
    if yaw_deg is not None:
        rows_s, (t_s, rate_dps) = t_s, rates_of(t_s, yaw_deg)
        after = [] if aids is None else [(int(np.searchsorted(t_s, rows_s[row])), aid) for row, aid in aids]
        aids = tuple((row, aid) for row, aid in after if row < len(t_s)) or (aids and ())
        return _with_samples(Session(name, t_s, rate_dps, aids=aids))
    columns["rate_dps"] = np.empty(0) if columns["rate_dps"] is None else columns["rate_dps"]
    if delta_deg is None:
        session = session_of_columns(name, columns, aids=aids)
        has_rate = np.isfinite(session.rate_dps) if aids else np.ones(len(session.rate_dps), bool)
        return _with_samples(session if has_rate.all() else session.rows(np.flatnonzero(has_rate)))
    rows, rate_dps = rates_of_deltas(t_s, delta_deg)
    whole = session_of_columns(name, columns | {"rate_dps": delta_deg}, aids=aids)
    return _with_samples(replace(whole.rows(rows), rate_dps=rate_dps))


def _row_aids(table_columns: TableColumns, read: ColumnsRead, t_s: Floats) -> RowAids:
    """Measurements of second sources in the rows, shape (n,), at times on their clock."""
    reader = AidColumns(table_columns.aids)
    meanings = [column.meaning for column in table_columns.aids]
    values = [np.empty(0) if (column := read.column(meaning)) is None else column for meaning in meanings]
    return tuple(
        (row, aid._replace(t_s=row_s + (0.0 if isnan(aid.t_s) else aid.t_s)))
        for row, (row_s, *cells) in enumerate(zip(t_s.tolist(), *(column.tolist() for column in values), strict=True))
        for aid in reader.aids_of(dict(zip(meanings, cells, strict=True)))
    )


def _with_samples(session: Session) -> Session:
    if not len(session.rate_dps):
        raise DataError(f"{session.name}: has no samples")
    return session


def _yaws(name: str, w: Floats, x: Floats, y: Floats, z: Floats) -> Floats:
    """Yaw of unit quaternions, deg, shape (n,); NaN for other norms.

    Raises
    ------
    DataError
        Most have another norm.
    """
    with np.errstate(all="ignore"):  # values may be no quaternion
        norm = np.sqrt(w * w + x * x + y * y + z * z)
        yaw_deg: Floats = np.degrees(np.arctan2(*yaw_parts(w, x, y, z)))
        is_unit = (norm >= NORMS[0]) & (norm <= NORMS[1])
        length = float(np.median(norm))
    if len(norm) and not NORMS[0] <= length <= NORMS[1]:
        scale = f"; if its parts are counts, write :lsb/{length:.5g} after q.w, q.x, q.y and q.z in --columns"
        raise DataError(f"{name}: its quaternions have the length {length:.4g}, not 1{scale if length > 1.0 else ''}")
    return np.where(is_unit, yaw_deg, np.nan)


def _check_axis(head: Head, table_columns: TableColumns, parts: Sequence[Floats]) -> None:
    """Check that quaternions turn about z.

    Raises
    ------
    DataError
        They turn about another axis: y points up, as in graphics, or the scalar is another of q0 to q3.
    """
    indices = [next(c.index for c in table_columns.used if c.target == f"q{part}") for part in "wxyz"]
    label = head.labels[indices[0]] if head.labels else "0"
    orders = {"if its scalar comes last, ": SCALAR_LAST} if label[-1:].isdigit() else {}
    orders |= {"if y points up, ": Y_UP, "if x points up, ": X_UP}
    path_deg = {why: _paths_deg([parts[i] for i in order]) for why, order in ({"": (0, 1, 2, 3)} | orders).items()}
    own_deg = path_deg[""]
    if max(own_deg) < LEAST_PATH_DEG or own_deg[2] > AXIS_SHARE * max(own_deg):
        return
    for why, order in orders.items():
        if path_deg[why][2] > max(own_deg[2], AXIS_SHARE * max(path_deg[why])):
            changes = {indices[i]: f"q.{part}" for part, i in zip("wxyz", order, strict=True)}
            spec = spec_of(head, table_columns, changes)
            axis = "xyz"[own_deg.index(max(own_deg))]
            sign = "" if order is SCALAR_LAST else ", and --flip if it is left-handed, as of Unity"
            raise DataError(
                f"{head.path}: its quaternion turns about {axis}, not about z: {why}state --columns '{spec}'{sign}"
            )


def _paths_deg(parts: Sequence[Floats]) -> list[float]:
    """Angle that quaternions turn about each fixed axis, in either direction, deg."""
    stack = np.array(parts)
    steps = stack[:, np.isfinite(stack).all(axis=0)]
    steps = steps[:, :: max(1, steps.shape[1] // AXIS_STEPS)]
    (aw, ax, ay, az), (bw, bx, by, bz) = steps[:, :-1], steps[:, 1:]
    real = aw * bw + ax * bx + ay * by + az * bz
    vector = (
        aw * bx - ax * bw - by * az + bz * ay,
        aw * by - ay * bw - bz * ax + bx * az,
        aw * bz - az * bw - bx * ay + by * ax,
    )
    return [float(2.0 * np.degrees(np.abs(np.arctan2(part, np.abs(real))).sum())) for part in vector]


def rates_of(t_s: Floats, angle_deg: Floats) -> tuple[Floats, Floats]:
    """Times in s and mean rates since the previous time in deg/s, for angles that wrap.

    Of equal times the last angle counts. A backward step of the clock gives NaN.
    """
    is_angle = np.isfinite(t_s) & (np.abs(angle_deg) <= MOST_DEG)
    t_s, angle_deg = t_s[is_angle], angle_deg[is_angle]
    if not len(t_s):
        return t_s, angle_deg
    is_last = np.append(np.diff(t_s) != 0.0, [True])
    t_s, angle_deg = t_s[is_last], angle_deg[is_last]
    step_s = np.diff(t_s)
    change_deg = (np.diff(angle_deg) + 0.5 * FULL_TURN_DEG) % FULL_TURN_DEG - 0.5 * FULL_TURN_DEG
    rate_dps = np.full(len(step_s), np.nan)
    np.divide(change_deg, step_s, out=rate_dps, where=step_s > 0.0)
    return t_s[1:], rate_dps
