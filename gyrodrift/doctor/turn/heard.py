"""Received turn: lines or samples over time, the rests, the turn between them, and its result."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from gyrodrift.columns.units import Dimension, Unit
from gyrodrift.doctor.turn.motion import TurnWindow
from gyrodrift.doctor.turn.series import ColumnKey, Series, TextTable
from gyrodrift.doctor.turn.spec import read_back, spec_of
from gyrodrift.doctor.turn.verdict import TurnVerdict, judge
from gyrodrift.values.sample import Sample


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
    """Judge a turn, and test the SPEC on its lines."""
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
