"""The keys `axes:` and `mount:` of a config."""

from collections.abc import Callable
from typing import Any

from firmware_sim.strict_yaml import Key
from gyrodrift.config.explain import describe_value, unknown_key
from gyrodrift.filters.run import AXES, Axes
from gyrodrift.values.mount import AXES as DIRECTIONS
from gyrodrift.values.mount import LEVEL, Mount


def axes_in(value: Any, report: Callable[[Key, str], None]) -> Axes:
    """Axes from the value of `axes:`; auto if it is absent or wrong."""
    named = {"auto" if value is None else str(value)} & set(AXES) if not isinstance(value, bool) else set()
    if named:
        return named.pop()  # type: ignore[return-value]
    report((), f"is {describe_value(value)}; expected auto, 1 or 3")
    return "auto"


def mount_in(value: Any, report: Callable[[Key, str], None]) -> Mount:
    """Mount from the value of `mount:`; that of a level sensor if it is absent or wrong."""
    if value is None:
        return LEVEL
    if not isinstance(value, dict):
        report((), f"is {describe_value(value)}; expected a block such as {{up: +z, forward: +x}}")
        return LEVEL
    given = {"up": LEVEL.up, "forward": LEVEL.forward}
    for name, direction in value.items():
        if name not in given:
            report((str(name),), unknown_key(str(name), list(given), "a key of mount"))
        elif direction not in DIRECTIONS:
            report(
                (name,), f"is {describe_value(direction)}; expected {', '.join(DIRECTIONS[:-1])} or {DIRECTIONS[-1]}"
            )
        else:
            given[name] = direction
    try:
        return Mount(**given)
    except ValueError as error:
        report((), str(error))
        return LEVEL
