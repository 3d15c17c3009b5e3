"""The names that somebody may have meant, of those that are known."""

from collections.abc import Iterable

ALIKE = 0.6
"""How alike a name has to be, from 0 to 1: what `difflib` takes where nobody says."""


def nearest(word: str, known: Iterable[str], most: int = 1, alike: float = ALIKE) -> list[str]:
    """Those of the known names that are near, the nearest first, in whichever case the word was written."""
    from difflib import get_close_matches  # noqa: PLC0415 - for who mistyped something

    names = {name.lower(): name for name in known}
    return [names[each] for each in get_close_matches(word.lower(), names, n=most, cutoff=alike)]


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """The question whether the nearest was meant; nothing where none is near."""
    return question(nearest(word, known))


def question(names: Iterable[str]) -> str:
    """Whether one of these was meant; nothing where there are none."""
    found = " or ".join(names)
    return f"did you mean {found}?" if found else ""
