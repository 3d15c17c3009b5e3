"""The filters there are, by the names that a config gives them; all else finds them here.

A filter of this project is one more record in `SHIPPED`. A program that uses this package calls `register`.
"""

from collections.abc import Mapping
from dataclasses import fields
from types import MappingProxyType

from gyrodrift.filters.filter import Filter
from gyrodrift.filters.hdr_filter import HDR
from gyrodrift.filters.restlevel_filter import RESTLEVEL

SHIPPED = (HDR, RESTLEVEL)

DEFAULT = RESTLEVEL
"""Default filter."""

PUBLISHED = HDR
"""Default filter of evaluations: the filter with published results."""

CONFIG_KEYS = frozenset(
    {"filter", "sample_rate_hz", "provenance", "outputs", "text", "columns", "send", "calibration", "axes", "mount"}
)
"""Keys of a config that are not the block of a filter."""

_registered: dict[str, Filter] = {}

FILTERS: Mapping[str, Filter] = MappingProxyType(_registered)
"""Filters by name, in the order of registration."""


def register(new: Filter) -> None:
    """Make a filter known to config, `serve`, `filter`, `tune` and `compare`.

    Raises
    ------
    ValueError
        If the name is taken or invalid, or the parameters differ from those of the record.
    """
    if new.name in FILTERS or new.name in CONFIG_KEYS or not new.name.isidentifier():
        raise ValueError(f"{new.name!r}: a filter needs a unique name of letters, digits and underscores")
    described, named = (
        tuple(parameter.name for parameter in new.parameters),
        tuple(field.name for field in fields(new.params)),
    )
    if described != named:
        raise ValueError(f"{new.name}: parameters describe {', '.join(described)}; its record has {', '.join(named)}")
    if not new.searched:
        raise ValueError(f"{new.name}: none of its parameters has a range to search")
    _registered[new.name] = new


def unregister(name: str) -> None:
    """Remove a filter; running instances are not affected."""
    del _registered[name]


for _shipped in SHIPPED:
    register(_shipped)
