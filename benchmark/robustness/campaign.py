"""The campaign of faults: every one at three strengths by every protocol, then pairs; its rows and its table."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from robustness.account import Tally, tally
from robustness.scaled import Story, play
from robustness.strengths import LIES, RUN_S, STRENGTHS, TO_S, all_pairs, pairs, single

PROTOCOLS = ("native", "csv", "witmotion")
CHECKED = "native"
"""The protocol whose frames have a CRC of 16 bits."""

YAW_OFF_DEG = 1.0
"""How far yaw may part from that of the run without the fault, deg, where every rate that came was true."""

BACK_S = 1.0
HELD_BACK_SHARE = 0.2
"""Without a checksum a good frame beside damage may look like damage: at most such a share of what the link damaged."""

NUMBERS = ("sent", "lost by the link", "lost by us", "wrong")

Faults = tuple[tuple[str, int], ...]
"""Names with their strength, 1 to 3."""


@dataclass(frozen=True, slots=True)
class FaultRow:
    """One run of the table; `off_deg` is how far yaw came off the run without the fault, None where nothing came."""

    protocol: str
    faults: Faults
    tally: Tally
    off_deg: float | None
    damaged: int
    refused: str
    told: tuple[str, ...]

    @property
    def name(self) -> str:
        """As the table has it."""
        return " + ".join(f"{name} {strength}" for name, strength in self.faults)

    def broken_promises(self) -> list[str]:
        """What must not be, and was."""
        return list(_broken(self))


def run(protocol: str, faults: Faults, seed: int = 1) -> FaultRow:
    """Play one, and count."""
    story = _played(protocol, faults, seed)
    found, without = tally(story, TO_S), _without(protocol, seed)
    common = found.yaw_deg.keys() & without.yaw_deg.keys()
    off_deg = abs(found.yaw_deg[max(common)] - without.yaw_deg[max(common)]) if common else None
    told = tuple(dict.fromkeys(event for event, _ in story.events))
    return FaultRow(protocol, faults, found, off_deg, story.damaged, story.refused, told)


def run_of(case: tuple[str, Faults], seed: int) -> FaultRow:
    """The same of a protocol and its faults, for a process that is handed them."""
    return run(*case, seed)


def single_runs() -> Iterator[tuple[str, Faults]]:
    """All faults, alone."""
    for protocol in PROTOCOLS:
        for name in STRENGTHS:
            for strength in (1, 2, 3):
                yield protocol, ((name, strength),)


def paired_runs(count: int, seed: int) -> Iterator[tuple[str, Faults]]:
    """All pairs by the checked protocol, and so many at random by each of the others."""
    for protocol in PROTOCOLS:
        for both in all_pairs() if protocol == CHECKED else pairs(count, seed):
            yield protocol, both


def table(rows: Sequence[FaultRow]) -> str:
    """In Markdown."""
    lines = _head("protocol", "fault, strength", *NUMBERS, "received", "back after, s", "yaw off, deg")
    for row in rows:
        each = row.tally
        back = "-" if each.back_s is None else f"{each.back_s:.2f}"
        numbers = (each.sent, each.lost_by_link, each.lost_by_us, each.wrong, each.received, back, _off(row))
        lines.append(f"| {row.protocol} | {row.name} | {' | '.join(map(str, numbers))} |")
    return "\n".join(lines)


def summary(rows: Sequence[FaultRow]) -> str:
    """A line for each protocol."""
    lines = _head("protocol", "runs", *NUMBERS, "back after at most, s", "yaw off at most, deg")
    for protocol in PROTOCOLS:
        own = [row for row in rows if row.protocol == protocol]
        if own:
            lines.append(f"| {protocol} | {len(own)} | {' | '.join(_sums(own))} |")
    return "\n".join(lines)


def by_fault(rows: Sequence[FaultRow]) -> str:
    """A line for each fault that acted alone, its three strengths side by side."""
    columns = ("lost by the link", "wrong", "yaw off, deg")
    lines = _head("fault", *(f"{protocol}: {each}" for protocol in PROTOCOLS for each in columns))
    alone = {(row.protocol, *row.faults[0]): row for row in rows if len(row.faults) == 1}
    for name in STRENGTHS:
        cells = []
        for protocol in PROTOCOLS:
            three = [alone[protocol, name, strength] for strength in (1, 2, 3)]
            cells.append([str(row.tally.lost_by_link) for row in three])
            cells.append([str(row.tally.wrong) for row in three])
            cells.append([_off(row) for row in three])
        lines.append(f"| `{name}` | {' | '.join(_once(cell) for cell in cells)} |")
    return "\n".join(lines)


def _off(row: FaultRow) -> str:
    if row.refused or row.off_deg is None:
        return "refused" if row.refused else "-"
    return f"{row.off_deg:.2f}" if row.off_deg < 10.0 else f"{row.off_deg:.0f}"


def _once(three: list[str]) -> str:
    return three[0] if len(set(three)) == 1 else " / ".join(three)


def _head(*columns: str) -> list[str]:
    return [f"| {' | '.join(columns)} |", f"|{'---|' * len(columns)}"]


def _sums(rows: Sequence[FaultRow]) -> Iterable[str]:
    tallies = [row.tally for row in rows]
    yield str(sum(each.sent for each in tallies))
    yield str(sum(each.lost_by_link for each in tallies))
    yield str(sum(each.lost_by_us for each in tallies))
    yield str(sum(each.wrong for each in tallies))
    yield f"{max((each.back_s or 0.0 for each in tallies), default=0.0):.2f}"
    yield f"{max((row.off_deg or 0.0 for row in rows if _is_true(row)), default=0.0):.2f}"


def _broken(row: FaultRow) -> Iterator[str]:
    each = row.tally
    if row.refused:
        return
    if row.protocol == CHECKED:
        if each.lost_by_us:
            yield f"{each.lost_by_us} samples that arrived whole were lost"
        if each.wrong:
            yield f"{each.wrong} wrong samples passed a checksum"
        if _is_true(row) and (row.off_deg is None or row.off_deg > YAW_OFF_DEG):
            yield f"yaw came off by {row.off_deg} deg"
    elif each.lost_by_us > 1 + HELD_BACK_SHARE * each.lost_by_link:
        yield f"{each.lost_by_us} samples that arrived whole were lost"
    elif each.wrong > each.lost_by_link:
        yield f"{each.wrong} wrong samples of {each.lost_by_link} damaged ones"
    if _is_quick(row) and (each.back_s is None or each.back_s > BACK_S):
        yield f"back in step after {each.back_s} s"


def _is_true(row: FaultRow) -> bool:
    """Whether all rates and times were those of the table."""
    return not row.refused and not {name for name, _ in row.faults} & {*LIES, "millisecond_clock"}


def _is_quick(row: FaultRow) -> bool:
    """Whether the device still speaks often enough to be back within `BACK_S`."""
    return not {name for name, _ in row.faults} & {"rate_change", "millisecond_clock"}


def _played(protocol: str, faults: Faults, seed: int) -> Story:
    with TemporaryDirectory() as folder:
        return play(Path(folder), protocol, [single(name, strength) for name, strength in faults], RUN_S, seed)


@cache
def _without(protocol: str, seed: int) -> Tally:
    """The same device without a fault."""
    return tally(_played(protocol, (), seed), TO_S)
