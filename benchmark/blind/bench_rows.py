"""What is scored of the set `bench`: rows with a goal, and a few that explain them."""

from collections.abc import Iterable
from dataclasses import replace

from gyrogap.physics.sizes import STRENGTHS

from blind import judge
from blind.score import Share, false_alarms, interval_row, left_out_rows, outside_rows, pair_rows, parameter_row, row
from blind.tried import Tried


def bench_rows(tried: list[Tried]) -> list[Share]:
    """The table; rows that were not run say so."""
    return [
        *_quiet_rows(tried),
        *_single_rows(tried),
        *_outside_rows(tried),
        *_pair_rows(tried),
        row("three at once: all named", _in(tried, "triple"), _names_all, 0.6),
        *left_out_rows(tried),
        parameter_row(tried),
        interval_row(tried),
        *_loop_rows(tried),
        *_wrong_size_rows(tried),
        *_baseline_rows(tried),
        row("everywhere: no cause above 0.8 that is not there", tried, _invents_nothing),
    ]


def _in(tried: Iterable[Tried], *rows: str) -> list[Tried]:
    return [case for case in tried if case.row in rows]


def _quiet_rows(tried: list[Tried]) -> list[Share]:
    rows = {
        "none_own": "no gap, own simulator: none",
        "none_short": "no gap, own simulator, 3 × 40 s: none",
        "none_generator": "no gap, generator: none",
        "none_driven": "no gap, robots that tremble, hands and drones: none",
    }
    return [
        row(what, _in(tried, name), lambda case: not judge.raises_alarm(case.blind), 0.95)
        for name, what in rows.items()
    ]


def _names_all(case: Tried) -> bool:
    return judge.names_both(case.blind, tuple(case.truths), alone=False)


def _group(case: Tried) -> bool:
    return judge.names_group_first(case.blind, case.truth)


def _effect(case: Tried) -> bool:
    return judge.names_first_or_tied(case.blind, case.truth)


def _single_rows(tried: list[Tried]) -> list[Share]:
    """Those that the device without the effect said it would not show are listed apart, named or not."""
    shares = []
    for name, sizes, goals in (("single", "typical and large", (0.95, 0.9)), ("small", "small", (0.7, 0.7))):
        cases = _in(tried, name)
        seen = [case for case in cases if _would_be_seen(case)]
        apart = [case for case in cases if case not in seen]
        shares += [
            row(f"group named first, {sizes}", seen, _group, goals[0]),
            row(f"effect named first or tied first, {sizes}", seen, _effect, goals[1]),
            row(f"said to be too small to be seen, {sizes}: named first or tied first all the same", apart, _effect),
            row(f"said to be too small to be seen, {sizes}: none", apart, _is_quiet),
            row(
                f"said to be too small to be seen, {sizes}: one of both",
                apart,
                lambda case: _is_quiet(case) or _effect(case),
                is_listed=True,
            ),
        ]
    return shares


def _outside_rows(tried: list[Tried]) -> list[Share]:
    """Those that cost as little yaw as `diagnose` calls negligible are listed apart: "none" is right there, too."""
    cases = _in(tried, "outside")
    cheap = [case for case in cases if case.yaw_cost_deg is not None and case.yaw_cost_deg < judge.NEGLIGIBLE_DEG]
    costly = [case for case in cases if case not in cheap]

    def is_told(case: Tried) -> bool:
        return judge.abstains_at(case.blind, case.stages)

    return [
        *outside_rows(tried),
        row("outside the catalogue, costs 0.3 deg of yaw or more: at the right stage", costly, is_told, 0.8),
        row("outside the catalogue, costs less: at the right stage", cheap, is_told),
        row(
            "outside the catalogue, costs less: at the right stage, or none",
            cheap,
            lambda case: _is_quiet(case) or is_told(case),
            is_listed=True,
        ),
        row("outside the catalogue: no cause above 0.8 that is not there", cases, _invents_nothing, 0.95),
    ]


def _pair_rows(tried: list[Tried]) -> list[Share]:
    """All of them, and those of which the device without them said that it would show each by itself."""
    seen = [
        case for case in _in(tried, "pair") if all(_is_as_large_as(case, effect, "without") for effect in case.truths)
    ]
    return [
        *pair_rows(tried),
        row(
            "pairs, neither said to be too small to be seen: both named, nothing else confident",
            seen,
            lambda case: judge.names_both(case.blind, tuple(case.truths), alone=True),
            0.75,
        ),
    ]


def _would_be_seen(case: Tried) -> bool:
    return _is_as_large_as(case, case.truth, "without")


def _is_as_large_as(case: Tried, effect: str, run: str) -> bool:
    """Whether an effect of a case has at least the size that a run says is detectable."""
    sized = STRENGTHS[effect]
    falls = sized.sizes[0] > sized.sizes[-1]
    return judge.would_be_seen(case.outcomes[run], effect, case.truths[effect], sized.parameter, falls=falls)


def _stands_out_of_baseline(case: Tried) -> bool:
    return _is_as_large_as(case, case.truth, "blind")


def _is_quiet(case: Tried) -> bool:
    return not judge.raises_alarm(case.blind)


def _invents_nothing(case: Tried) -> bool:
    return not judge.invents(case.blind, case.truths)


def _loop_rows(tried: list[Tried]) -> list[Share]:
    """New sessions against the rig that was adopted, where there was anything to adopt."""
    cases = _in(tried, "loop")
    adopted = [case for case in cases if case.blind.names_causes]
    return [
        row("loop: there is a cause to adopt", cases, lambda case: case.blind.names_causes),
        row(
            "loop: adopted, recorded again: none",
            adopted,
            lambda case: not judge.raises_alarm(case.outcomes["again"]),
            0.95,
            "again",
        ),
    ]


def _wrong_size_rows(tried: list[Tried]) -> list[Share]:
    cases = _in(tried, "wrong_size")

    def is_right(case: Tried) -> bool:
        cause, parameter = judge.cause_of(case.blind.said, case.truth), STRENGTHS[case.truth].parameter
        is_near = cause is not None and judge.fit_is_near(cause, parameter, case.strength[parameter])
        return is_near and judge.names_wrong_size(case.blind, case.truth)

    return [
        row("in the rig at a wrong size: named as that, new size within 20 %", cases, is_right, 0.9),
        row("in the rig at a wrong size: named as that", cases, lambda c: judge.names_wrong_size(c.blind, c.truth)),
    ]


def _baseline_rows(tried: list[Tried]) -> list[Share]:
    """Those that the run itself says are too small to stand out of this baseline are listed apart."""
    cases = _in(tried, "baseline")
    seen = [case for case in cases if _stands_out_of_baseline(case)]
    apart = [case for case in cases if case not in seen]
    quiet = false_alarms(_in(tried, "baseline_none"))
    what = "put into real recordings, against a baseline"
    return [
        row(f"{what}: group named first", seen, _group, 0.9),
        row(f"{what}: effect named first or tied first", seen, _effect),
        row(f"{what}, said to be too small to be seen: named first or tied first all the same", apart, _effect),
        replace(quiet, what="real recordings against a baseline: false alarms"),
    ]
