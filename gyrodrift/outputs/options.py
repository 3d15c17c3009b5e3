"""How the options of an output are declared: a frozen dataclass of annotated fields, each with a default.

    @dataclass(frozen=True, slots=True)
    class TcpOptions:
        host: Annotated[Host, About("address to listen on")] = LOOPBACK
        port: Annotated[Port, About("port to listen on; 0 takes a free one")] = 7117
        rate_hz: Annotated[Rate, About("at most so many lines a second of device time")] = None

Fields are text, secrets (`SecretText`), whole numbers, numbers, truth values, a `Literal` of words, or one of these or
None. `config.outputs`
checks what a person gives against them.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Annotated, Any, get_type_hints

from annotated_types import Ge, Gt, Le, MaxLen, MinLen, Predicate

from gyrodrift.secret import SecretText, without_secrets

LOOPBACK = "127.0.0.1"


@dataclass(frozen=True, slots=True)
class About:
    """What an option means to a person, in one line."""

    text: str


NOT_IN_A_HOST = "@/"
"""Characters of addresses such as `mqtt://user:password@host`, which would show a password wherever a host is shown."""


def is_host(text: str) -> bool:
    """Whether a text may be a host: a name or an address alone."""
    return not set(NOT_IN_A_HOST) & set(text)


Host = Annotated[str, MinLen(1), MaxLen(253), Predicate(is_host)]
"""A name or address."""

Port = Annotated[int, Ge(0), Le(65535)]
"""Of TCP or UDP; 0 takes a free one, where it is listened on."""

Rate = Annotated[float, Gt(0.0), Le(1e6)] | None
"""Hz; None for every sample."""

Seconds = Annotated[float, Gt(0.0), Le(86400.0)]


@dataclass(frozen=True, slots=True)
class OutputSpec:
    """An output that was asked for: its name, and its options with everything filled in."""

    name: str
    options: Any

    def __str__(self) -> str:
        """As `--output` would have it, without what is as it is anyway."""
        given = [
            f"{each.name}={without_secrets(str(getattr(self.options, each.name)))}"
            for each in fields(self.options)
            if getattr(self.options, each.name) != each.default
        ]
        return f"{self.name}:{','.join(given)}" if given else self.name


def about(options: type[Any]) -> dict[str, str]:
    """What each option means, by its name."""
    hints = get_type_hints(options, include_extras=True)
    return {
        each.name: next(
            (note.text for note in getattr(hints[each.name], "__metadata__", ()) if isinstance(note, About)), ""
        )
        for each in fields(options)
    }


def secrets(options: type[Any]) -> frozenset[str]:
    """The options that are shown to nobody."""
    hints = get_type_hints(options)
    return frozenset(each.name for each in fields(options) if hints[each.name] is SecretText)


def revealed(options: Any) -> dict[str, Any]:
    """The options with their secrets, for the process of the outputs alone."""
    values = {each.name: getattr(options, each.name) for each in fields(options)}
    return {name: value.reveal() if isinstance(value, SecretText) else value for name, value in values.items()}


def options_from(options: type[Any], given: Mapping[str, Any]) -> Any:
    """The options that `revealed` gave."""
    hidden = secrets(options)
    return options(**{name: SecretText(value) if name in hidden else value for name, value in given.items()})
