"""What the filter of a recording began with: kept in the file, so that whoever runs it again gets the same bits.

Of a file that goes on where another one ended that is all the filter was at its first sample, yaw included.
"""

import json
from collections.abc import Mapping

from gyrodrift.errors import DataError
from gyrodrift.filters.filter import Filter, FilterState
from gyrodrift.filters.saved import restore, saved

TABLE = "filter"


def table_of(kind: Filter, state: FilterState) -> dict[str, dict[str, str]]:
    """For the metadata of a recording; nothing for a filter that begins anew."""
    known = saved(state, kind.state())
    return {TABLE: {"name": kind.name, "began_with": json.dumps(known)}} if known else {}


def beginning_of(kind: Filter, metadata: Mapping[str, Mapping[str, str]], name: str) -> FilterState | None:
    """The state that this filter began with in a recording of that name; None where that says nothing of it.

    Raises
    ------
    DataError
        Where it is none of such a filter.
    """
    table = metadata.get(TABLE, {})
    if table.get("name") != kind.name or "began_with" not in table:
        return None
    state: FilterState = kind.state()
    try:
        restore(state, json.loads(table["began_with"]))
    except (ValueError, TypeError, AttributeError, IndexError, KeyError, RecursionError) as error:
        raise DataError(f"{name}: what its filter began with is damaged, or of another version: {error}") from error
    return state
