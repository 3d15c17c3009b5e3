"""Plans of a tuning: the filters to tune, each with its search method and its axes."""

from collections.abc import Sequence

from gyrodrift.evaluation.space import with_ranges
from gyrodrift.filters.filter import Filter
from gyrodrift.filters.registry import FILTERS, SHIPPED
from gyrodrift.tune.tuning import Plan
from gyrodrift.values.errors import UsageError

METHOD = "race"
"""Search method for a filter that is named."""

METHODS_OF_BOTH = {"hdr": "carla", "restlevel": METHOD}
"""Search method of each filter if none is named: HDR as published, with CARLA."""


def plans_of(
    filter_name: str | None, evaluations: int, seeds: tuple[int, ...], method: str | None, ranges: Sequence[str]
) -> tuple[Plan, ...]:
    """One plan for the named filter, or one for each shipped filter.

    Parameters
    ----------
    ranges
        `NAME=LOW:HIGH`; a range applies to the filter that has the parameter.

    Raises
    ------
    UsageError
        If no planned filter has a parameter, or a range is wrong.
    """
    chosen = SHIPPED if filter_name is None else (FILTERS[filter_name],)
    _check_names(chosen, ranges)
    return tuple(
        Plan(
            evaluations,
            seeds,
            method or (METHOD if filter_name else METHODS_OF_BOTH.get(kind.name, METHOD)),
            with_ranges([text for text in ranges if _name(text) in kind.names], kind),
            kind,
        )
        for kind in chosen
    )


def _name(text: str) -> str:
    return text.partition("=")[0].strip()


def _check_names(chosen: Sequence[Filter], ranges: Sequence[str]) -> None:
    names = [name for kind in chosen for name in kind.names]
    for text in ranges:
        if _name(text) not in names:
            raise UsageError(f"--range {text}: unknown parameter {_name(text)}; there are {', '.join(names)}")
