"""The text of a YAML file without its secrets: the key stays, the value is `***`, and comments are not kept.

It works on the events of the parser, so that no file is too deep for it.
"""

from collections.abc import Iterator
from typing import TYPE_CHECKING

from gyrodrift.secret import HIDDEN, is_secret_name, mentions_secret, without_secrets

if TYPE_CHECKING:
    import yaml

LONGEST = 128 << 10
"""Characters; a config is no longer (`config.yaml.LONGEST_BYTES`)."""

NOT_KEPT = "# not kept: it mentions secrets and cannot be read\n"
WIDEST = 1000
"""Characters of a line that is not folded."""


def public_yaml(text: str) -> str:
    """The same text where it mentions no secret; else its values without secrets and comments."""
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


class _Place:
    """Where in the file an event stands: in which open blocks, and whether a key or a value comes next."""

    def __init__(self) -> None:
        self._is_key_due: list[bool | None] = []  # None in a list

    def take(self) -> bool:
        """Move on past the beginning of a node; whether that node is a key."""
        due = self._is_key_due[-1] if self._is_key_due else None
        if due is not None:
            self._is_key_due[-1] = not due
        return bool(due)

    def enter(self, *, is_block: bool) -> None:
        """A block or a list begins."""
        self._is_key_due.append(True if is_block else None)

    def leave(self) -> None:
        """It ends."""
        self._is_key_due.pop()


def _public(events: Iterator["yaml.Event"]) -> Iterator["yaml.Event"]:
    """Events in which the values of secret keys are `***`."""
    import yaml  # noqa: PLC0415 - likewise

    place = _Place()
    for event in events:
        is_key = place.take() if isinstance(event, yaml.NodeEvent) else False
        if isinstance(event, yaml.CollectionStartEvent):
            place.enter(is_block=isinstance(event, yaml.MappingStartEvent))
        elif isinstance(event, yaml.CollectionEndEvent):
            place.leave()
        if not isinstance(event, yaml.ScalarEvent):
            yield event
            continue
        yield _scalar(event, without_secrets(event.value))
        if is_key and is_secret_name(event.value):
            _pass_over(events)
            place.take()
            yield yaml.ScalarEvent(None, None, (True, True), HIDDEN, style='"')


def _scalar(event: "yaml.ScalarEvent", text: str) -> "yaml.ScalarEvent":
    """The event with another text."""
    import yaml  # noqa: PLC0415 - likewise

    return event if text == event.value else yaml.ScalarEvent(event.anchor, None, (True, True), text, style='"')


def _pass_over(events: Iterator["yaml.Event"]) -> None:
    """Leave out one node with all that is in it."""
    import yaml  # noqa: PLC0415 - likewise

    depth = 0
    for event in events:
        depth += isinstance(event, yaml.CollectionStartEvent) - isinstance(event, yaml.CollectionEndEvent)
        if not depth:
            return
