"""Words of messages: suggestions for a misspelled name, names in a sentence, and numbers of things."""

from collections.abc import Iterable

SIMILARITY = 0.6
"""Smallest similarity of a suggestion, from 0 to 1: the default of `difflib`."""


def nearest(word: str, names: Iterable[str], count: int = 1, similarity: float = SIMILARITY) -> list[str]:
    """At most `count` names that are similar to a word, the most similar first; case is ignored."""
    from difflib import get_close_matches  # noqa: PLC0415 - imported only for a mistake

    by_lower = {name.lower(): name for name in names}
    return [by_lower[name] for name in get_close_matches(word.lower(), by_lower, n=count, cutoff=similarity)]


def did_you_mean(word: str, names: Iterable[str]) -> str:
    """`did you mean NAME?`; empty if no name is similar."""
    return suggestion(nearest(word, names))


def suggestion(names: Iterable[str]) -> str:
    """`did you mean A or B?`; empty without names."""
    choices = " or ".join(names)
    return f"did you mean {choices}?" if choices else ""


def listed(names: Iterable[str], word: str = "and") -> str:
    """Names as in a sentence: `a, b and c`, or with another word before the last; empty without names."""
    *first, last = [*names] or [""]
    return f"{', '.join(first)} {word} {last}" if first else last


def counted(count: int, noun: str) -> str:
    """`1 sample` or `2 samples`; of `read of raw bytes` the first word gets the plural."""
    head, joint, rest = noun.partition(" of ")
    return f"{count} {head}{'s' * (count != 1)}{joint}{rest}"
