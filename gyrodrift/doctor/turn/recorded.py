"""A quarter turn in a file: raw bytes or samples of a session, or a text with a clock among its columns."""

from pathlib import Path

import numpy as np

from gyrodrift.columns.spec import CLOCK_US
from gyrodrift.doctor.turn.heard import HeardTurn, TurnResult, result_of
from gyrodrift.doctor.turn.listen import LIMIT_S, REST_S, TEXTS
from gyrodrift.doctor.turn.motion import TurnWindow
from gyrodrift.doctor.turn.series import ColumnKey, LineTimes, TextTable, TimedLine, table_of
from gyrodrift.errors import DataError
from gyrodrift.files import UnreadableError, check_ordinary
from gyrodrift.link.heard import decoded, plain_text
from gyrodrift.link.text.guess import guess
from gyrodrift.sample import Sample

LEAST_BEFORE_S = 0.5
LARGEST_TEXT = 64_000_000
"""Bytes; of a longer file the beginning is looked at."""


def recorded_turn(path: Path, turn_at_s: float) -> TurnResult:
    """Judge the turn that begins `turn_at_s` after the first line or sample of a file.

    Raises
    ------
    DataError
        Where the file cannot be read, has no times, or does not reach so far.
    """
    if path.suffix.lower() == ".mcap":
        heard = _of_session(path, turn_at_s)
    else:
        table = table_of(_timed_lines(path))
        heard = HeardTurn(str(path), _window(path, turn_at_s, *_ends(path, [each.t_s for each in table.lines])), table)
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
        return HeardTurn(str(path), _window(path, turn_at_s, *_ends(path, [each.t_s for each in table.lines])), table)
    t_s = session.t_device_s
    samples = tuple(
        Sample(at, float(time_s), float(time_s), float(rate_dps), np.nan, np.nan, np.nan)
        for at, (time_s, rate_dps) in enumerate(zip(t_s, session.rate_dps, strict=True))
    )
    return HeardTurn(
        str(path), _window(path, turn_at_s, *_ends(path, t_s.tolist())), samples=samples, protocol=protocol or "csv"
    )


def _ends(path: Path, times_s: list[float]) -> tuple[float, float]:
    if not times_s:
        raise DataError(f"{path}: has no lines with numbers, nor samples")
    return times_s[0], times_s[-1]


def _window(path: Path, turn_at_s: float, first_s: float, last_s: float) -> TurnWindow:
    if not LEAST_BEFORE_S <= turn_at_s < last_s - first_s:
        raise DataError(
            f"{path}: --turn-at {turn_at_s:g}: the file lasts {last_s - first_s:.4g} s; the turn has to begin within"
            f" it, after at least {LEAST_BEFORE_S:g} s of rest"
        )
    turn_s = first_s + turn_at_s
    return TurnWindow(max(first_s, turn_s - REST_S), turn_s, min(last_s, turn_s + LIMIT_S))


def _timed_lines(path: Path) -> list[TimedLine]:
    """The lines of a text by the clock among its columns."""
    try:
        check_ordinary(path)
        with path.open("rb") as file:
            content = file.read(LARGEST_TEXT)
    except UnreadableError as error:
        raise DataError(f"{path}: {error}: this is no text") from error
    except OSError as error:
        raise DataError(f"{path}: cannot be read: {error.strerror}") from error
    lines = [line.strip() for line in decoded(plain_text(content)).replace("\r", "\n").split("\n") if line.strip()]
    guessed = guess(lines)
    places = [at for at, each in enumerate(guessed.columns) if each.entry.startswith("t_")] if guessed else []
    if not any(map(str.strip, lines)) or guessed is None:
        raise DataError(f"{path}: no lines with numbers repeat in it; this is no text of a device")
    if not places:
        raise DataError(
            f"{path}: no column of it is a clock, so the length of the turn is not known; record with"
            " gyrodrift record --raw, or turn at the port: gyrodrift doctor --port PORT --turn"
        )
    clock, label = guessed.columns[places[0]], guessed.labels[places[0]]
    key = ColumnKey(label) if label else ColumnKey(place=places[0], width=len(guessed.columns))
    return _by_clock(lines, key, CLOCK_US[clock.entry])


def _by_clock(lines: list[str], key: ColumnKey, tick_us: float) -> list[TimedLine]:
    """Each line at the time that it, or the last one before it, says."""
    counted = [TimedLine(float(at), line) for at, line in enumerate(lines)]
    clock = next(each for each in table_of(counted).series() if each.key == key)
    at = np.searchsorted(clock.t_s, np.arange(len(lines)), side="right") - 1
    times_s = 1e-6 * tick_us * (clock.values - clock.values[0])
    return [TimedLine(float(times_s[place]), line) for place, line in zip(at, lines, strict=True) if place >= 0]
