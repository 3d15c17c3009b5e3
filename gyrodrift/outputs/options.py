"""Declaration of the options of an output: a frozen dataclass of annotated fields with defaults.

    @dataclass(frozen=True, slots=True)
    class TcpOptions:
        host: Annotated[Host, About("address to listen on")] = LOOPBACK
        port: Annotated[Port, About("port to listen on; 0 takes a free one")] = 7117
        rate_hz: Annotated[Rate, About("at most this many lines a second of device time")] = None

Fields are text, secrets (`SecretText`), whole numbers, numbers, truth values, or a `Literal` of words; all of them can
be optional. `config.outputs` checks values against these declarations.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Annotated, Any, get_type_hints

from annotated_types import Ge, Gt, Le, MaxLen, MinLen, Predicate

from gyrodrift.values.secret import SecretText, without_secrets

LOOPBACK = "127.0.0.1"


@dataclass(frozen=True, slots=True)
class About:
    """Description of an option in one line."""

    text: str


NOT_IN_A_HOST = "@/"
"""Characters that a host may not have: they occur in `mqtt://user:password@host`, which would show a password."""


def is_host(text: str) -> bool:
    """Whether a text can be a host, a name or an address without user and path."""
    return not set(NOT_IN_A_HOST) & set(text)


Host = Annotated[str, MinLen(1), MaxLen(253), Predicate(is_host)]
"""A name or address."""

Port = Annotated[int, Ge(0), Le(65535)]
"""Port of TCP or UDP; 0 takes a free one to listen on."""

Rate = Annotated[float, Gt(0.0), Le(1e6)] | None
"""Hz; None for every sample."""

Seconds = Annotated[float, Gt(0.0), Le(86400.0)]


@dataclass(frozen=True, slots=True)
class OutputSpec:
    """A wanted output: its name, and its options with all defaults."""

    name: str
    options: Any

    def __str__(self) -> str:
        """Argument of `--output`, without defaults and secrets."""
        changed = [
            f"{field.name}={without_secrets(str(getattr(self.options, field.name)))}"
            for field in fields(self.options)
            if getattr(self.options, field.name) != field.default
        ]
        return f"{self.name}:{','.join(changed)}" if changed else self.name


def about(options: type[Any]) -> dict[str, str]:
    """Descriptions of the options, by name."""
    hints = get_type_hints(options, include_extras=True)
    return {
        field.name: next(
            (note.text for note in getattr(hints[field.name], "__metadata__", ()) if isinstance(note, About)), ""
        )
        for field in fields(options)
    }


def secrets(options: type[Any]) -> frozenset[str]:
    """Names of the secret options."""
    hints = get_type_hints(options)
    return frozenset(field.name for field in fields(options) if hints[field.name] is SecretText)


def revealed(options: Any) -> dict[str, Any]:
    """Options with their secrets, for the process of the outputs."""
    values = {field.name: getattr(options, field.name) for field in fields(options)}
    return {name: value.reveal() if isinstance(value, SecretText) else value for name, value in values.items()}


def options_from(options: type[Any], values: Mapping[str, Any]) -> Any:
    """Options from the values of `revealed`."""
    hidden = secrets(options)
    return options(**{name: SecretText(value) if name in hidden else value for name, value in values.items()})
