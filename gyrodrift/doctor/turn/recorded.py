"""Quarter turn in a file: raw bytes or samples of a session, or a text with a clock column."""

from pathlib import Path

import numpy as np

from gyrodrift.columns.guess import guess
from gyrodrift.columns.spec import CLOCK_US
from gyrodrift.columns.turn.motion import TurnWindow
from gyrodrift.columns.turn.series import ColumnKey, LineTimes, TextTable, TimedLine, table_of
from gyrodrift.doctor.turn.heard import HeardTurn, TurnResult, result_of
from gyrodrift.doctor.turn.listen import LIMIT_S, REST_S, TEXTS
from gyrodrift.io.files import UnreadableError, check_ordinary
from gyrodrift.io.plain_text import decoded, plain_text
from gyrodrift.values.errors import DataError
from gyrodrift.values.sample import Sample

REST_BEFORE_MIN_S = 0.5
TEXT_BYTES_MAX = 64_000_000
"""Bytes of a text that are read."""


def recorded_turn(path: Path, turn_at_s: float) -> TurnResult:
    """Judge the turn that begins `turn_at_s` after the first line or sample of a file.

    Raises
    ------
    DataError
        The file cannot be read, has no times, or is too short.
    """
    if path.suffix.lower() == ".mcap":
        heard = _of_session(path, turn_at_s)
    else:
        table = table_of(_timed_lines(path))
        heard = HeardTurn(str(path), _window(path, turn_at_s, *_ends(path, [line.t_s for line in table.lines])), table)
    return result_of(heard)


def _of_session(path: Path, turn_at_s: float) -> HeardTurn:
    from gyrodrift.session.mcap.raw import raw_size, read_raw  # noqa: PLC0415 - a text needs none of it
    from gyrodrift.session.mcap.read import read_mcap  # noqa: PLC0415

    session = read_mcap(path)
    protocol = session.metadata.get("recording", {}).get("protocol", "")
    if raw_size(path) is not None and protocol in TEXTS:
        splitter, table = LineTimes(), TextTable()
        for read in read_raw(path):
            for line in splitter.split(read.content, read.t_host_s):
                table.take(line)
        return HeardTurn(str(path), _window(path, turn_at_s, *_ends(path, [line.t_s for line in table.lines])), table)
    t_s = session.t_device_s
    samples = tuple(
        Sample(index, float(time_s), float(time_s), float(rate_dps), np.nan, np.nan, np.nan)
        for index, (time_s, rate_dps) in enumerate(zip(t_s, session.rate_dps, strict=True))
    )
    return HeardTurn(
        str(path), _window(path, turn_at_s, *_ends(path, t_s.tolist())), samples=samples, protocol=protocol or "csv"
    )


def _ends(path: Path, times_s: list[float]) -> tuple[float, float]:
    if not times_s:
        raise DataError(f"{path}: has neither lines with numbers nor samples")
    return times_s[0], times_s[-1]


def _window(path: Path, turn_at_s: float, first_s: float, last_s: float) -> TurnWindow:
    if not REST_BEFORE_MIN_S <= turn_at_s < last_s - first_s:
        raise DataError(
            f"{path}: --turn-at {turn_at_s:g}: the file lasts {last_s - first_s:.4g} s; the turn must begin within"
            f" it, after at least {REST_BEFORE_MIN_S:g} s of rest"
        )
    turn_s = first_s + turn_at_s
    return TurnWindow(max(first_s, turn_s - REST_S), turn_s, min(last_s, turn_s + LIMIT_S))


def _timed_lines(path: Path) -> list[TimedLine]:
    """Lines of a text, timed by its clock column."""
    try:
        check_ordinary(path)
        with path.open("rb") as file:
            content = file.read(TEXT_BYTES_MAX)
    except UnreadableError as error:
        raise DataError(f"{path}: {error}: this is not a text") from error
    except OSError as error:
        raise DataError(f"{path}: cannot be read: {error.strerror}") from error
    lines = [line.strip() for line in decoded(plain_text(content)).replace("\r", "\n").split("\n") if line.strip()]
    guessed = guess(lines)
    columns = guessed.columns if guessed else ()
    clocks = [index for index, column in enumerate(columns) if column.entry.startswith("t_")]
    if not any(map(str.strip, lines)) or guessed is None:
        raise DataError(f"{path}: it has no repeated lines with numbers; this is not the text of a device")
    if not clocks:
        raise DataError(
            f"{path}: it has no clock column, so the length of the turn is unknown; record with gyrodrift"
            " record --raw, or turn at the port: gyrodrift doctor --port PORT --turn"
        )
    clock, label = guessed.columns[clocks[0]], guessed.labels[clocks[0]]
    key = ColumnKey(label) if label else ColumnKey(index=clocks[0], width=len(guessed.columns))
    return _by_clock(lines, key, CLOCK_US[clock.looks_like])


def _by_clock(lines: list[str], key: ColumnKey, tick_us: float) -> list[TimedLine]:
    """Lines with the time of their clock, or of the last clock before them."""
    counted = [TimedLine(float(index), line) for index, line in enumerate(lines)]
    clock = next(column for column in table_of(counted).series() if column.key == key)
    clock_indices = np.searchsorted(clock.t_s, np.arange(len(lines)), side="right") - 1
    times_s = 1e-6 * tick_us * (clock.values - clock.values[0])
    timed = zip(clock_indices, lines, strict=True)
    return [TimedLine(float(times_s[index]), line) for index, line in timed if index >= 0]
