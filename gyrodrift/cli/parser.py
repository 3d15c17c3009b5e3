"""How a command line is read: what is unknown gets the nearest that is known, before anything else is complained of."""

import argparse
import re
from collections.abc import Iterable, Sequence
from typing import Any, NoReturn

from gyrodrift.errors import UsageError, shortened
from gyrodrift.nearest import nearest, question

RENAMED = {"--threads": "--jobs"}
"""Options that users may know by another name."""

NEAREST = 2
"""So many that are known are offered for one that is not."""

LONGEST_QUOTE = 40
"""Characters of a value that is not understood."""

NUMBER = re.compile(r"-\.?\d")
UNTOLD: tuple[object, ...] = (None, False, "", [], argparse.SUPPRESS)
"""Defaults that say nothing by themselves: the help says what happens."""


def begun_or_near(word: str, known: Iterable[str]) -> str:
    """The question whether one was meant that begins so, or is near; nothing where there is none."""
    names = list(known)
    begun = [name for name in names if name.startswith(word)]
    return question(begun[:NEAREST] or nearest(word, names, NEAREST))


def nearest_or_all(word: str, known: Iterable[str]) -> str:
    """The same, and all that are known where none is near."""
    names = list(known)
    return begun_or_near(word, names) or f"there are {', '.join(names)}"


def unknown(what: str, word: str, known: Iterable[str]) -> UsageError:
    """For a name that is none, behind its option where it has one; `what` says of what."""
    return UsageError(f"{word}: there is no such {what}; {nearest_or_all(word.rpartition(' ')[2], known)}")


class HelpFormatter(argparse.RawDescriptionHelpFormatter):
    """Descriptions as they stand, and each option with its default."""

    def _get_help_string(self, action: argparse.Action) -> str | None:
        text = action.help or ""
        if "default" in text or any(action.default is each or action.default == each for each in UNTOLD):
            return text
        return f"{text} (default %(default)s)"


class Parser(argparse.ArgumentParser):
    """A parser whose complaints are one line each, and `UsageError`s."""

    def __init__(self, name: str = "", **options: Any) -> None:
        super().__init__(
            prog=f"gyrodrift {name}".rstrip(), formatter_class=HelpFormatter, allow_abbrev=False, **options
        )
        self._name = name

    def read(self, words: Sequence[str]) -> argparse.Namespace:
        """The options of a command line.

        Raises
        ------
        UsageError
            With every option that there is none of, or else the first mistake.
        """
        mistakes = [self._mistake(word.partition("=")[0]) for word in _options_in(words)]
        if any(mistakes):
            raise UsageError("\n".join(filter(None, mistakes)))
        return self.parse_args(words)

    def error(self, message: str) -> NoReturn:
        """Refuse the command line."""
        raise UsageError(f"{self._name}: {message}; {self._see}".removeprefix(": "))

    @property
    def _see(self) -> str:
        return f"gyrodrift help {self._name}".rstrip() + " shows them all"

    def _mistake(self, word: str) -> str:
        known = self._option_string_actions
        if word in known:
            return ""
        if RENAMED.get(word) in known:
            return f"{word}: is {RENAMED[word]} now"
        sought = f"-{word}" if re.fullmatch(r"-\w", word) else word
        meant = begun_or_near(sought, [option for option in known if option.startswith("--")])
        return f"{word}: {self._name or 'gyrodrift'} has no such option; {meant or self._see}"

    def _get_value(self, action: argparse.Action, arg_string: str) -> Any:
        """What an option does not take is told like any other mistake: the option, the value, what is expected."""
        try:
            return super()._get_value(action, arg_string)
        except argparse.ArgumentError as error:
            if isinstance(error.__context__, UsageError):  # argparse takes it for any other ValueError
                raise error.__context__ from None
            name = "/".join(action.option_strings) or action.metavar or action.dest
            raise UsageError(f"{name} {shortened(arg_string, LONGEST_QUOTE)}: {error.message}") from error

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        if action.choices is not None and value not in action.choices:
            name = "/".join(action.option_strings) or action.metavar or action.dest
            raise UsageError(f"{name} {value}: {nearest_or_all(str(value), map(str, action.choices))}")


def _options_in(words: Sequence[str]) -> Iterable[str]:
    """Those that can be nothing else."""
    for word in words:
        if word == "--":
            return
        if word.startswith("-") and word != "-" and not NUMBER.match(word):
            yield word
