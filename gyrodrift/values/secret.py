"""Secrets: a type that never shows its text, and functions that remove passwords and tokens from text.

An output declares a secret by its type (`SecretText`). Everywhere else a secret is recognized by its name: in the text
of a config, on a command line, in an address with `user:password@`.
"""

import re
from collections.abc import Iterable

HIDDEN = "***"
"""Replacement of every secret."""

WORD = r"(?:password|passwd|passphrase|secret|token|api_?key|credential)"
NAME = re.compile(rf"(?!.*(?:_file|_path)$)(?:.*{WORD}.*|pass|pwd)", re.IGNORECASE | re.DOTALL)
LONGEST_NAME = 128
"""Characters of a name that are examined."""

MESSAGE = "is|this|there|the|it|cannot|no|has|points"
"""First words of messages about a port or a file, whose name may end in such a word: `token: there is no such port`."""

ASSIGNED = re.compile(
    rf"({WORD}s?(?!_)[\"']?\s{{0,4}}[:=]\s{{0,4}}+)(?!(?:{MESSAGE}) )(?:\"[^\"]*+\"|'[^']*+'|\S++)", re.IGNORECASE
)
"""`password=…`, `"token": "…"` in a line of text, up to the next space."""

WITHIN_WORD = re.compile(rf"({WORD}s?(?!_)[=:]).++", re.IGNORECASE | re.DOTALL)
"""`password=…` in a word of a command line, up to its end: the secret may hold spaces and commas."""

ADDRESS = re.compile(r"(://[^\s:@/]{0,256}+:)\S{1,256}@")
"""`scheme://user:password@host`; bounded, so that the time is linear in the length of the text."""

MENTION = re.compile(rf"{WORD}(?!_file|_path)|\bpwd\b|\bpass\b|{ADDRESS.pattern}", re.IGNORECASE)
"""Parts of a text that may hold a secret."""


LONGEST_SECRET = 1024
"""Characters of a password."""


class SecretText:
    """A text that `repr`, `str`, formats and JSON show as `***`."""

    __slots__ = ("_text",)

    def __init__(self, text: str = "") -> None:
        self._text = text

    def reveal(self) -> str:
        """The text itself."""
        return self._text

    def __bool__(self) -> bool:
        return bool(self._text)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, SecretText) and self._text == other._text

    def __hash__(self) -> int:
        return hash((SecretText, self._text))

    def __repr__(self) -> str:
        return HIDDEN if self._text else ""


NO_SECRET = SecretText()


def is_secret_name(name: str) -> bool:
    """Whether a key of this name holds a secret; `password_file` does not."""
    return NAME.fullmatch(name[:LONGEST_NAME]) is not None


def mentions_secret(text: str) -> bool:
    """Whether a text may hold a secret."""
    return MENTION.search(text) is not None


def without_secrets(text: str) -> str:
    """A message or an address without its secrets."""
    return ADDRESS.sub(rf"\1{HIDDEN}@", ASSIGNED.sub(rf"\1{HIDDEN}", text))


def shown_key(name: str) -> str:
    """A key for a message; a key like `password:abc`, with a missing space, becomes `password…`."""
    head = name[: min((index for mark in ":= \t\n," if (index := name.find(mark)) >= 0), default=len(name))]
    return name if head == name else f"{head}…"


def shown_words(words: Iterable[str]) -> list[str]:
    """The words of a command line without secrets."""
    return [without_secrets(WITHIN_WORD.sub(rf"\1{HIDDEN}", word)) for word in words]
