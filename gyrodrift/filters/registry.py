"""The filters there are, by the names that a config gives them; all else finds them here.

A filter of this project is one more record in `SHIPPED`. Another package has an entry point of `gyrodrift.filters`, and
a program calls `register`.
"""

from dataclasses import fields
from typing import Any

from gyrodrift.filters.filter import Filter
from gyrodrift.filters.hdr_filter import HDR
from gyrodrift.filters.restlevel_filter import RESTLEVEL
from gyrodrift.io.plug_ins import EntryPoint, PlugIns, named_record

SHIPPED = (HDR, RESTLEVEL)

DEFAULT = RESTLEVEL
"""Default filter."""

PUBLISHED = HDR
"""Default filter of evaluations: the filter with published results."""

CONFIG_KEYS = frozenset(
    {
        "filter",
        "sample_rate_hz",
        "slew_dps",
        "provenance",
        "outputs",
        "text",
        "columns",
        "send",
        "calibration",
        "axes",
        "mount",
        "sources",
    }
)
"""Keys of a config that are not the block of a filter."""


def _accept(entry: EntryPoint, value: Any) -> Filter:
    chosen = named_record(Filter)(entry, value)
    _check(chosen)
    return chosen


FILTERS: PlugIns[Filter] = PlugIns("filter", _accept, CONFIG_KEYS)
"""Filters by name, in the order of registration, and those of plug-ins."""


def register(new: Filter) -> None:
    """Make a filter known to config, `serve`, `filter`, `tune` and `compare`.

    Raises
    ------
    ValueError
        If the name is taken or invalid, or the parameters differ from those of the record.
    """
    if new.name in FILTERS.own:
        raise ValueError(f"{new.name!r}: a filter needs a unique name of letters, digits and underscores")
    _check(new)
    FILTERS.own[new.name] = new


def _check(new: Filter) -> None:
    """Check the name of a filter, and that its parameters are those of its record.

    Raises
    ------
    ValueError
        They are not.
    """
    if new.name in CONFIG_KEYS or not new.name.isidentifier():
        raise ValueError(f"{new.name!r}: a filter needs a unique name of letters, digits and underscores")
    described, named = (
        tuple(parameter.name for parameter in new.parameters),
        tuple(field.name for field in fields(new.params)),
    )
    if described != named:
        raise ValueError(f"{new.name}: parameters describe {', '.join(described)}; its record has {', '.join(named)}")
    if not new.searched:
        raise ValueError(f"{new.name}: none of its parameters has a range to search")


def unregister(name: str) -> None:
    """Remove a filter; running instances are not affected."""
    del FILTERS.own[name]


for _shipped in SHIPPED:
    register(_shipped)
