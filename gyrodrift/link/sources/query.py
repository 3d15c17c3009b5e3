"""Options at the end of an address: `?NAME=VALUE&NAME=VALUE`."""

from collections.abc import Sequence
from urllib.parse import unquote

from gyrodrift.link.sources.source import SourceAddress
from gyrodrift.values.errors import UsageError


def split_query(address: SourceAddress, allowed: Sequence[str]) -> tuple[str, dict[str, str]]:
    """Address without its options, and the options by name.

    Raises
    ------
    UsageError
        An option is unknown, has no value, or stands there twice.
    """
    rest, _, query = address.rest.partition("?")
    options: dict[str, str] = {}
    for text in query.split("&") if query else ():
        name, _, value = text.partition("=")
        if name not in allowed or not value or name in options:
            expected = " and ".join(f"{name}=…" for name in allowed)
            raise UsageError(f"--port {address.text}: {text!r} is no option of this source; there are {expected}")
        options[name] = unquote(value)
    return rest, options
