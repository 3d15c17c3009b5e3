"""The score of a set: the rows of the table, each a share of cases that came out right, and figures beside them."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from statistics import median

from gyrogap.catalogue import JUDGED

from blind import judge
from blind.gap import Cause
from blind.probabilities import Bin, brier, reliability
from blind.tried import Tried

WORTH_SHRINKING = 0.05
"""Where the true effect itself shrinks the gap by less, the ratio to it says nothing."""


@dataclass(frozen=True, slots=True)
class Share:
    """A row: of `total` cases, `hits`; `goal` is None where none is set, `is_most` where fewer is better."""

    what: str
    hits: int
    total: int
    goal: float | None = None
    is_most: bool = False
    misses: tuple[str, ...] = ()

    @property
    def share(self) -> float:
        """0 where nothing was tried."""
        return self.hits / self.total if self.total else 0.0


@dataclass(frozen=True, slots=True)
class Score:
    """All there is to tell of a set."""

    shares: list[Share]
    shrink_ratio: float | None
    shrink_ratio_cases: int
    brier: float | None
    bins: list[Bin]
    median_s: float
    longest_s: float
    failures: int


def score(tried: list[Tried], rows_of: Callable[[list[Tried]], list[Share]]) -> Score:
    """Judge every case; `rows_of` says what the rows of the table are."""
    stated = _stated(tried)
    seconds = [case.blind.seconds for case in tried] or [0.0]
    ratios = _shrink_ratios(of_kind(tried, "single"))
    return Score(
        shares=rows_of(tried),
        shrink_ratio=median(ratios) if ratios else None,
        shrink_ratio_cases=len(ratios),
        brier=brier(stated),
        bins=reliability(stated),
        median_s=median(seconds),
        longest_s=max(seconds),
        failures=sum(case.blind.said is None for case in tried),
    )


Rule = Callable[[Tried], bool]


def row(
    what: str,
    cases: Iterable[Tried],
    rule: Rule,
    goal: float | None = None,
    run: str = "blind",
    *,
    is_most: bool = False,
    is_listed: bool = False,
) -> Share:
    """A share; misses are listed where there is a goal or it is asked for; where fewer is better they are the hits."""
    judged = [(case, rule(case)) for case in cases]
    misses = [_miss(case, run) for case, is_hit in judged if is_hit == is_most]
    hits = sum(is_hit for _, is_hit in judged)
    return Share(what, hits, len(judged), goal, is_most, tuple(misses) if goal is not None or is_listed else ())


def _miss(case: Tried, run: str) -> str:
    size = f"{case.size} " if case.size else ""
    of = f", {case.about}" if case.kind == "outside" or case.row else ""
    without = f", without {case.withhold}" if run == "withheld" else ""
    return f"{case.id}: {size}{case.put_in}{of}{without} → {case.outcomes[run].text}"


def of_kind(tried: list[Tried], kind: str) -> list[Tried]:
    """Cases of a kind."""
    return [case for case in tried if case.kind == kind]


def false_alarms(tried: list[Tried]) -> Share:
    """Of the cases without a gap."""
    return row("false alarms where there is no gap", of_kind(tried, "none"), _alarm, 0.05, is_most=True)


def outside_rows(tried: list[Tried]) -> list[Share]:
    """What no catalogue has."""
    return [
        row(
            "outside the catalogue: unknown or partly, at the right stage",
            of_kind(tried, "outside"),
            lambda c: judge.abstains_at(c.blind, c.stages),
            0.8,
        ),
        row("outside the catalogue: unknown or partly, at any stage", of_kind(tried, "outside"), _abstains),
    ]


def pair_rows(tried: list[Tried]) -> list[Share]:
    """Two effects at a time."""
    pairs = of_kind(tried, "pair")
    return [
        row("pairs: both named, nothing else confident", pairs, lambda c: _both(c, alone=True), 0.75),
        row("pairs: both named", pairs, lambda c: _both(c, alone=False)),
    ]


def _alarm(case: Tried) -> bool:
    return judge.raises_alarm(case.blind)


def _abstains(case: Tried) -> bool:
    return case.blind.said is not None and case.blind.said.verdict in {"unknown", "partly"}


def _both(case: Tried, *, alone: bool) -> bool:
    return judge.names_both(case.blind, tuple(case.truths), alone=alone)


def left_out_rows(tried: list[Tried]) -> list[Share]:
    """The true effect is withheld."""
    left_out = of_kind(tried, "left_out")
    return [
        row(
            "left out: no confident wrong cause without a leftover",
            left_out,
            lambda c: judge.is_not_fooled(c.outcomes["withheld"]),
            0.95,
            "withheld",
        ),
        row(
            "left out: unknown, or partly with nothing confident but of its group",
            left_out,
            lambda c: judge.admits_what_is_missing(c.outcomes["withheld"], c.truth),
        ),
        row(
            "left out: with the effect back less is left of the gap",
            left_out,
            lambda c: judge.shrinks_further(c.blind, c.outcomes["withheld"]),
        ),
        row(
            "left out: with the effect back it is named first or tied first",
            left_out,
            lambda c: judge.names_first_or_tied(c.blind, c.truth),
        ),
    ]


def parameter_row(tried: list[Tried]) -> Share:
    """Of cases in which the effect was named, where its form here is that of the simulator."""
    cases = [case for case in of_kind(tried, "single") if case.truth in JUDGED and _cause(case)]
    return row("fitted parameter within 20 %, where named and of the same form", cases, _is_near, 0.85)


def interval_row(tried: list[Tried]) -> Share:
    """Of the same cases."""
    cases = [case for case in of_kind(tried, "single") if case.truth in JUDGED and _cause(case)]
    return row("fitted parameter: its interval holds the truth", cases, _is_held, 0.92)


def _is_held(case: Tried) -> bool:
    cause, parameter = _cause(case), JUDGED[case.truth]
    return cause is not None and judge.interval_holds(cause, parameter, case.strength[parameter])


def _cause(case: Tried) -> Cause | None:
    return judge.cause_of(case.blind.said, case.truth)


def _is_near(case: Tried) -> bool:
    cause, parameter = _cause(case), JUDGED[case.truth]
    return cause is not None and judge.fit_is_near(cause, parameter, case.strength[parameter])


def _shrink_ratios(cases: list[Tried]) -> list[float]:
    """Shrink against the oracle's; nothing named is no shrink, and without an oracle there is no ratio."""
    ratios = []
    for case in cases:
        best = case.outcomes["oracle"].said
        if best is None or best.shrink is None or best.shrink < WORTH_SHRINKING:
            continue
        said = case.blind.said
        ratios.append((said.shrink or 0.0) / best.shrink if said else 0.0)
    return ratios


def _stated(tried: list[Tried]) -> list[tuple[float, bool]]:
    """Every probability of a blind run, and whether the effect was there."""
    return [
        (cause.probability, cause.effect in case.truths)
        for case in tried
        if case.blind.said
        for cause in case.blind.said.causes
    ]
