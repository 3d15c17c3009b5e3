"""Received turn: lines or samples over time, the rests, the turn between them, and its result."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import isfinite

import numpy as np

from gyrodrift.columns.sizes import TEMPERATURES_C
from gyrodrift.columns.spec import CLOCK_US, IGNORED, QUATERNION, columns_of, selection, spec_text
from gyrodrift.columns.turn.motion import TurnWindow, motion_of
from gyrodrift.columns.turn.scale import HAND, QUARTER_DEG
from gyrodrift.columns.turn.series import ColumnKey, Series, TextTable, TimedLine
from gyrodrift.columns.turn.verdict import AngleColumn, RateColumn, TurnVerdict, judge
from gyrodrift.columns.units import Dimension, Unit
from gyrodrift.link.text_decoder import TextDecoder
from gyrodrift.values.sample import Sample

PACE_WITHIN = 0.1
"""Largest relative difference between a clock and the arrival of its lines; units differ by a factor of 1000."""

GOES_ON, CHANGES = 0.98, 0.5
"""Shares of steps in which a clock does not go back, and in which it advances: a clock in seconds is too coarse."""

OFTEN = 0.9
"""Smallest number of values of a further column, as a share of those of the turning column."""


@dataclass(frozen=True, slots=True)
class ReadBack:
    """Turn and number of samples, if the lines are read with a SPEC."""

    turn_deg: float
    samples: int

    @property
    def is_quarter(self) -> bool:
        """Whether it is a quarter turn to the left, within the accuracy of a hand."""
        return 1.0 / (1.0 + HAND) ** 2 < self.turn_deg / QUARTER_DEG < (1.0 + HAND) ** 2


@np.errstate(all="ignore")  # a text may hold numbers of any size
def spec_of(verdict: TurnVerdict, series: Sequence[Series]) -> str:
    """SPEC for `--columns`; empty if nothing turned, or a SPEC cannot name the column."""
    yaw = verdict.column
    if yaw is None or yaw.motion.series.key.repeat:
        return ""
    key = yaw.motion.series.key
    sign = "" if yaw.turn_deg > 0.0 else ":-"
    unit = yaw.scale.option if isinstance(yaw, RateColumn) else yaw.unit
    entries = {key: f"{'rate' if isinstance(yaw, RateColumn) else 'yaw'}:{unit}{sign}"}
    if isinstance(yaw, AngleColumn) and yaw.parts:
        names = (f"{QUATERNION[0]}{sign}", *QUATERNION[1:])  # the inverse rotation has the other sign of w
        entries = {part.series.key: name for part, name in zip(yaw.parts, names, strict=True)}
    count_min = OFTEN * len(yaw.motion.series.values)  # a sample waits for the rarest of its columns
    further = [column for column in series if _is_same_line(column.key, key) and len(column.values) >= count_min]
    clocks = [(unit, column) for column in further if (unit := clock_of(column))]
    if clocks:
        order = list(CLOCK_US)
        unit, clock = min(clocks, key=lambda pair: (pair[1].kind != "clock", order.index(pair[0])))
        entries[clock.key] = unit
    if temperature := next(filter(_is_temperature, further), None):
        entries.setdefault(temperature.key, "temp")
    if key.label:
        keys = [column.key for column in series if column.key in entries]
        return spec_text([entries[column_key] for column_key in keys], [column_key.label for column_key in keys])
    return spec_text([entries.get(ColumnKey(index=index, width=key.width), IGNORED) for index in range(key.width)])


def _is_temperature(column: Series) -> bool:
    low_c, high_c = TEMPERATURES_C
    return column.kind == "temp" and bool(np.all((column.values > low_c) & (column.values < high_c)))


def _is_same_line(key: ColumnKey, yaw: ColumnKey) -> bool:
    """Whether a SPEC can name a column beside the column of yaw."""
    if yaw.label:
        return bool(key.label) and not key.repeat and key != yaw
    return not key.label and key.width == yaw.width and key != yaw


def clock_of(series: Series) -> str:
    """Unit of a clock column, from the arrival of its lines; empty if it is not a clock."""
    steps, passed_s = np.diff(series.values), float(np.ptp(series.t_s)) if len(series.t_s) else 0.0
    if passed_s <= 0.0 or (steps >= 0.0).mean() < GOES_ON or (steps > 0.0).mean() < CHANGES:
        return ""
    pace = float(steps[steps > 0.0].sum()) / passed_s
    units = {unit: pace * us * 1e-6 for unit, us in CLOCK_US.items()}
    return next((unit for unit, seconds in units.items() if abs(seconds - 1.0) < PACE_WITHIN), "")


@np.errstate(all="ignore")  # as above
def read_back(lines: Sequence[TimedLine], spec: str, window: TurnWindow) -> ReadBack:
    """Turn of the lines, read with the decoder of `serve`."""
    decoder = TextDecoder(columns_of(spec))
    samples = [(line.t_s, sample) for line in lines for sample in decoder.push(f"{line.text}\n".encode())]
    rates = [(t_s, sample.rate_dps) for t_s, sample in samples if isfinite(sample.rate_dps)]
    angles = [(t_s, sample.yaw_deg) for t_s, sample in samples if isfinite(sample.yaw_deg)]
    pairs = rates or angles
    if not pairs:
        return ReadBack(0.0, 0)
    t_s, values = (np.array(column) for column in zip(*pairs, strict=True))
    key = ColumnKey()
    if rates:
        return ReadBack(motion_of(Series(key, "", "", None, t_s, values, is_whole=False), window).integral, len(pairs))
    smooth = np.unwrap(values, period=360.0)
    return ReadBack(motion_of(Series(key, "", "", None, t_s, smooth, is_whole=False), window).change, len(pairs))


@dataclass(frozen=True, slots=True)
class HeardTurn:
    """Turn at a port or in a file.

    table
        Lines of text; empty for a binary protocol.
    samples
        Samples of the binary protocol `protocol`; empty otherwise.
    """

    source: str
    window: TurnWindow
    table: TextTable = field(default_factory=TextTable)
    samples: Sequence[Sample] = ()
    protocol: str = ""


@dataclass(frozen=True, slots=True)
class TurnResult:
    """Result of a turn, and the tested SPEC; `read_deg` is the turn of the lines, read with that SPEC."""

    heard: HeardTurn
    verdict: TurnVerdict
    spec: str = ""
    read_deg: float = 0.0
    question: str = ""

    @property
    def is_found(self) -> bool:
        """Whether yaw can be read."""
        return not self.question


def result_of(heard: HeardTurn) -> TurnResult:
    """Judge a turn, and test the SPEC on its lines; of several senders in the lines, the one that turned."""
    label, senders = heard.table.senders()
    if not senders:
        return _result_of(heard)
    results = {sender: _result_of(replace(heard, table=heard.table.of_sender(label, sender))) for sender in senders}
    clear = {sender: result for sender, result in results.items() if result.is_found}
    if len(clear) != 1:
        names = ", ".join(clear or results)
        question = f"{label} names several senders, and {names} turned; turn one of them alone, or send only one"
        return replace(next(iter(results.values())), spec="", question=question if clear else _first_question(results))
    ((sender, result),) = clear.items()
    return replace(result, spec=f"{selection(label, sender)}, {result.spec}")


def _first_question(results: Mapping[str, TurnResult]) -> str:
    return next(result.question for result in results.values())


def _result_of(heard: HeardTurn) -> TurnResult:
    series = series_of(heard)
    verdict = judge(series, heard.window)
    if heard.samples or verdict.column is None:
        return TurnResult(heard, verdict, question=verdict.question)
    spec = spec_of(verdict, series)
    if not spec:
        name = verdict.column.motion.series.name
        question = f"{name} turned, but a line has its label more than once; give every value its own label"
        return TurnResult(heard, verdict, question=question)
    read = read_back(heard.table.lines, spec, heard.window)
    if not read.is_quarter:
        question = (
            f"read with --columns '{spec}', the lines turned by {read.turn_deg:.0f} deg instead of 90: there are lines"
            " of several kinds, or many are damaged; print lines of one kind only"
        )
        return TurnResult(heard, verdict, read_deg=read.turn_deg, question=question)
    return TurnResult(heard, verdict, spec, read.turn_deg)


def series_of(heard: HeardTurn) -> list[Series]:
    """Columns of the lines, or the rate of a protocol without columns."""
    return [series_of_samples(heard.samples)] if heard.samples else heard.table.series()


def series_of_samples(samples: Sequence[Sample]) -> Series:
    """Rate of a protocol with a fixed unit."""
    t_s, rate_dps = (np.array([getattr(sample, name) for sample in samples]) for name in ("t_device_s", "rate_dps"))
    is_valid = np.isfinite(rate_dps)
    unit = Unit(Dimension.RATE, "dps")
    return Series(ColumnKey("rate_dps"), "the rate", "rate", unit, t_s[is_valid], rate_dps[is_valid], is_whole=False)
