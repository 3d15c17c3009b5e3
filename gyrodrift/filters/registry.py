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
"""What runs where nothing is said."""

PUBLISHED = HDR
"""What is tuned and measured where nothing is said: the one that there are published figures of."""

CONFIG_KEYS = frozenset({"filter", "sample_rate_hz", "provenance", "outputs", "text"})
"""Keys of a config that are no filter's block."""

_registered: dict[str, Filter] = {}

FILTERS: Mapping[str, Filter] = MappingProxyType(_registered)
"""All of them, in the order in which they were registered."""


def register(new: Filter) -> None:
    """Make a filter known to config, `serve`, `filter`, `tune` and `compare`.

    Raises
    ------
    ValueError
        Where its name is taken or is no key of a config, or its parameters are not those of its record.
    """
    if new.name in FILTERS or new.name in CONFIG_KEYS or not new.name.isidentifier():
        raise ValueError(f"{new.name!r}: a filter needs a name of its own, of letters, digits and underscores")
    known, named = tuple(one.name for one in new.parameters), tuple(each.name for each in fields(new.params))
    if known != named:
        raise ValueError(f"{new.name}: parameters describe {', '.join(known)}; its record has {', '.join(named)}")
    if not new.searched:
        raise ValueError(f"{new.name}: none of its parameters has a range to search")
    _registered[new.name] = new


def unregister(name: str) -> None:
    """Forget a filter; whoever runs it keeps it."""
    del _registered[name]


for _each in SHIPPED:
    register(_each)
