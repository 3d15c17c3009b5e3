"""Initial filter state of a recording, kept in the file, so that a second run gives the same bits.

A file that continues another one has the full state of the filter at its first sample, yaw included.
"""

import json
from collections.abc import Mapping

from gyrodrift.filters.filter import Filter, FilterState
from gyrodrift.filters.run import FilterRun
from gyrodrift.filters.saved import restore, saved
from gyrodrift.values.errors import DataError

TABLE = "filter"


def table_of(kind: Filter, state: FilterState) -> dict[str, dict[str, str]]:
    """Metadata for a recording; empty for a filter with a new state."""
    differences = saved(state, kind.state())
    return {TABLE: {"name": kind.name, "began_with": json.dumps(differences)}} if differences else {}


def beginning_table(run: FilterRun) -> dict[str, dict[str, str]]:
    """Metadata for a recording that begins now; empty on three axes, whose state is not kept."""
    return {} if run.three_axes is not None else table_of(run.filter, run.state)


def beginning_of(kind: Filter, metadata: Mapping[str, Mapping[str, str]], name: str) -> FilterState | None:
    """Initial state of this filter in a recording; None if the recording has none.

    Raises
    ------
    DataError
        If the state does not belong to such a filter.
    """
    table = metadata.get(TABLE, {})
    if table.get("name") != kind.name or "began_with" not in table:
        return None
    state: FilterState = kind.state()
    try:
        restore(state, json.loads(table["began_with"]))
    except (ValueError, TypeError, AttributeError, IndexError, KeyError, RecursionError) as error:
        raise DataError(f"{name}: its initial filter state is damaged or of another version: {error}") from error
    return state
