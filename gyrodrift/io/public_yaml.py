"""The text of a YAML file without secrets: a secret value becomes `***`, and comments are removed.

It works on the events of the parser, so the depth of a file has no limit.
"""

from collections.abc import Iterator
from typing import TYPE_CHECKING

from gyrodrift.values.secret import HIDDEN, is_secret_name, mentions_secret, without_secrets

if TYPE_CHECKING:
    import yaml

LONGEST = 128 << 10
"""Longest text, in characters, as `config.yaml.LONGEST_BYTES`."""

NOT_KEPT = "# not kept: it mentions secrets and cannot be read\n"
WIDEST = 1000
"""Longest line that is not folded, in characters."""


def public_yaml(text: str) -> str:
    """Text without secrets and comments; a text that mentions no secret is returned as it is."""
    if not mentions_secret(text):
        return text
    if len(text) > LONGEST:
        return NOT_KEPT
    import yaml  # noqa: PLC0415 - few files mention a secret

    try:
        events = list(_public(yaml.parse(text, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))))
        kept: str = yaml.emit(events, width=WIDEST, allow_unicode=True)
    except (yaml.YAMLError, UnicodeError, RecursionError, ValueError):
        return NOT_KEPT
    return kept


class _Position:
    """Position in the file: the open blocks, and whether a key or a value comes next."""

    def __init__(self) -> None:
        self._is_key_due: list[bool | None] = []  # None in a list

    def take(self) -> bool:
        """Advance past the beginning of a node; whether that node is a key."""
        due = self._is_key_due[-1] if self._is_key_due else None
        if due is not None:
            self._is_key_due[-1] = not due
        return bool(due)

    def enter(self, *, is_block: bool) -> None:
        """Begin a block or a list."""
        self._is_key_due.append(True if is_block else None)

    def leave(self) -> None:
        """End a block or a list."""
        self._is_key_due.pop()


def _public(events: Iterator["yaml.Event"]) -> Iterator["yaml.Event"]:
    """Events in which the values of secret keys are `***`."""
    import yaml  # noqa: PLC0415 - few files mention a secret

    position = _Position()
    for event in events:
        is_key = position.take() if isinstance(event, yaml.NodeEvent) else False
        if isinstance(event, yaml.CollectionStartEvent):
            position.enter(is_block=isinstance(event, yaml.MappingStartEvent))
        elif isinstance(event, yaml.CollectionEndEvent):
            position.leave()
        if not isinstance(event, yaml.ScalarEvent):
            yield event
            continue
        yield _scalar(event, without_secrets(event.value))
        if is_key and is_secret_name(event.value):
            _pass_over(events)
            position.take()
            yield yaml.ScalarEvent(None, None, (True, True), HIDDEN, style='"')


def _scalar(event: "yaml.ScalarEvent", text: str) -> "yaml.ScalarEvent":
    """The event with another text."""
    import yaml  # noqa: PLC0415 - few files mention a secret

    return event if text == event.value else yaml.ScalarEvent(event.anchor, None, (True, True), text, style='"')


def _pass_over(events: Iterator["yaml.Event"]) -> None:
    """Skip one node with its contents."""
    import yaml  # noqa: PLC0415 - few files mention a secret

    depth = 0
    for event in events:
        depth += isinstance(event, yaml.CollectionStartEvent) - isinstance(event, yaml.CollectionEndEvent)
        if not depth:
            return
