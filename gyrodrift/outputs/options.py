"""How the options of an output are declared: a frozen dataclass of annotated fields, each with a default.

    @dataclass(frozen=True, slots=True)
    class TcpOptions:
        host: Annotated[Host, About("address to listen on")] = LOOPBACK
        port: Annotated[Port, About("port to listen on; 0 takes a free one")] = 7117
        rate_hz: Annotated[Rate, About("at most so many lines a second of device time")] = None

Fields are text, whole numbers, numbers, truth values, a `Literal` of words, or one of these or None. `config.outputs`
checks what a person gives against them.
"""

from dataclasses import dataclass, fields
from typing import Annotated, Any, get_type_hints

from annotated_types import Ge, Gt, Le, MaxLen, MinLen

LOOPBACK = "127.0.0.1"


@dataclass(frozen=True, slots=True)
class About:
    """What an option means to a person, in one line."""

    text: str


@dataclass(frozen=True, slots=True)
class Secret:
    """Marks an option that is shown to nobody: `status` and the log have stars in its place."""


HIDDEN = "***"

Host = Annotated[str, MinLen(1), MaxLen(253)]
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
        hidden = secrets(type(self.options))
        given = [
            f"{each.name}={HIDDEN if each.name in hidden else getattr(self.options, each.name)}"
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
    hints = get_type_hints(options, include_extras=True)
    return frozenset(
        each.name
        for each in fields(options)
        if any(isinstance(note, Secret) for note in getattr(hints[each.name], "__metadata__", ()))
    )
