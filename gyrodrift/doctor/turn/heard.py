"""A turn as it was heard: lines or samples over time, the rests and the turn between them, and what they say."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from gyrodrift.columns.units import Dimension, Unit
from gyrodrift.doctor.turn.motion import TurnWindow
from gyrodrift.doctor.turn.series import ColumnKey, Series, TextTable
from gyrodrift.doctor.turn.spec import read_back, spec_of
from gyrodrift.doctor.turn.verdict import TurnVerdict, judged
from gyrodrift.sample import Sample


@dataclass(frozen=True, slots=True)
class HeardTurn:
    """A turn at a port or in a file.

    table
        Lines of text; without numbers where a known protocol is spoken.
    samples
        Of a known protocol that is no text, named `protocol`; empty otherwise.
    """

    source: str
    window: TurnWindow
    table: TextTable = field(default_factory=TextTable)
    samples: Sequence[Sample] = ()
    protocol: str = ""


@dataclass(frozen=True, slots=True)
class TurnResult:
    """What a turn says, and the SPEC that was tried on it; `read_deg` is what the lines turn by that SPEC."""

    heard: HeardTurn
    verdict: TurnVerdict
    spec: str = ""
    read_deg: float = 0.0
    question: str = ""

    @property
    def is_found(self) -> bool:
        """Whether it is known how yaw is read."""
        return not self.question


def result_of(heard: HeardTurn) -> TurnResult:
    """Judge a turn, and try on its own lines what is to be pasted."""
    series = series_of(heard)
    verdict = judged(series, heard.window)
    if heard.samples or verdict.turned is None:
        return TurnResult(heard, verdict, question=verdict.question)
    spec = spec_of(verdict, series)
    if not spec:
        name = verdict.turned.motion.series.name
        question = f"{name} turned, but its label stands in a line more than once; give each value a label of its own"
        return TurnResult(heard, verdict, question=question)
    read = read_back(heard.table.lines, spec, heard.window)
    if not read.is_quarter:
        question = (
            f"read by --columns '{spec}', the lines turned by {read.turned_deg:.0f} deg rather than 90: lines of"
            " several kinds take turns, or many are damaged; let the device print lines of one kind"
        )
        return TurnResult(heard, verdict, read_deg=read.turned_deg, question=question)
    return TurnResult(heard, verdict, spec, read.turned_deg)


def series_of(heard: HeardTurn) -> list[Series]:
    """The columns of its lines, or the rate of a protocol that has no columns."""
    return [sampled(heard.samples)] if heard.samples else heard.table.series()


def sampled(samples: Sequence[Sample]) -> Series:
    """The rate of a protocol that states its unit."""
    t_s, rate_dps = (np.array([getattr(each, name) for each in samples]) for name in ("t_device_s", "rate_dps"))
    known = np.isfinite(rate_dps)
    unit = Unit(Dimension.RATE, "dps")
    return Series(ColumnKey("rate_dps"), "the rate", "rate", unit, t_s[known], rate_dps[known], is_whole=False)
