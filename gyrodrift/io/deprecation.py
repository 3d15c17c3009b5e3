"""Names that go: their successor, and the release that removes them (docs/stability.md has the rule).

The command line, the config and Python ask here alone. A deprecated name works as before, and says so once.
"""

import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass


class GyrodriftDeprecation(DeprecationWarning):
    """Use of a name that a later release removes."""


@dataclass(frozen=True, slots=True)
class Deprecated:
    """Successor of a name, and the releases that deprecated it and remove it."""

    successor: str
    since: str
    removed_in: str


DEPRECATED = {"--threads": Deprecated("--jobs", "0.1.0", "0.3.0")}
"""Options, config keys and Python names that go, by their name."""


@contextmanager
def told_deprecations() -> Iterator[None]:
    """Print each deprecation as a line on stderr, also where Python hides such warnings; filters that raise stay."""
    if any(action == "error" for action, _, kind, *_ in warnings.filters if issubclass(GyrodriftDeprecation, kind)):
        yield
        return
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", GyrodriftDeprecation)
        yield
    for warning in caught:
        if issubclass(warning.category, GyrodriftDeprecation):
            print(f"gyrodrift: {warning.message}", file=sys.stderr)  # noqa: T201 - for the user of the command
        else:
            warnings.showwarning(warning.message, warning.category, warning.filename, warning.lineno)


def successor_of(name: str) -> str:
    """Successor of a deprecated name, with a warning; empty for every other name."""
    entry = DEPRECATED.get(name)
    if entry is None:
        return ""
    text = f"{name}: is {entry.successor} now, and goes with {entry.removed_in}"
    warnings.warn(text, GyrodriftDeprecation, stacklevel=3)
    return entry.successor
