"""The command line parser: an unknown word is reported first, with the nearest known one."""

import argparse
import re
from collections.abc import Container, Iterable, Iterator, Sequence
from typing import Any, NoReturn

from gyrodrift.io.deprecation import DEPRECATED, successor_of
from gyrodrift.io.plug_ins import PlugIns
from gyrodrift.values.errors import UsageError, shortened
from gyrodrift.values.words import nearest, suggestion

COLUMN_OPTIONS = frozenset({"--rate-unit", "--time-unit", "--sample-rate", "--accel-unit", "--flip", "--reference"})
"""Options besides --columns that `gyrodrift help columns` explains."""

NEAREST = 2
"""Most suggestions for an unknown word."""

LONGEST_QUOTE = 40
"""Longest quote of a value that is not understood, characters."""

NUMBER = re.compile(r"-\.?\d")
HIDDEN_DEFAULTS: tuple[object, ...] = (None, False, "", [], argparse.SUPPRESS)
"""Defaults that the help does not print."""


def begun_or_near(word: str, names: Iterable[str]) -> str:
    """`did you mean NAME?` for names that begin with a word, or else are similar to it; empty without such names."""
    names = list(names)
    begun = [name for name in names if name.startswith(word)]
    return suggestion(begun[:NEAREST] or nearest(word, names, NEAREST))


def nearest_or_all(word: str, names: Iterable[str]) -> str:
    """`did you mean NAME?`, or the list of all names if none is similar."""
    names = list(names)
    return begun_or_near(word, names) or f"there are {', '.join(names)}"


def unknown(what: str, word: str, names: Iterable[str]) -> UsageError:
    """Error for an unknown name, with the kind of name in `what`."""
    return UsageError(f"{word}: there is no such {what}; {nearest_or_all(word.rpartition(' ')[2], names)}")


class Choices(Container[str]):
    """Names of a registry as the choices of an option; plug-ins are looked for if a name is none of ours."""

    def __init__(self, registry: PlugIns[Any], *first: str) -> None:
        self._registry, self._first = registry, first

    def __contains__(self, name: object) -> bool:
        return name in self._first or (name in self._registry and bool(self._registry[str(name)]))

    def __iter__(self) -> Iterator[str]:
        return iter([*self._first, *self._registry])

    @property
    def from_plug_ins(self) -> str:
        """Words for the help: the names that other packages add; empty without any."""
        added = [name for name in self if name not in self._first and name not in self._registry.own]
        return f"; from plug-ins: {', '.join(added)}" if added else ""


class HelpFormatter(argparse.RawDescriptionHelpFormatter):
    """Help that keeps the layout of descriptions and prints the default of each option."""

    def _get_help_string(self, action: argparse.Action) -> str | None:
        text = action.help or ""
        if isinstance(action.choices, Choices):
            text += action.choices.from_plug_ins
        if "default" in text or any(action.default is hidden or action.default == hidden for hidden in HIDDEN_DEFAULTS):
            return text
        return f"{text} (default %(default)s)"


class HelpAll(argparse.Action):
    """Print the help with all options, and end."""

    def __init__(self, option_strings: Sequence[str], dest: str, **words: Any) -> None:
        super().__init__(option_strings, dest, nargs=0, default=argparse.SUPPRESS, **words)

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        """Print it."""
        print(parser.format_help(), end="")
        parser.exit()


class Parser(argparse.ArgumentParser):
    """A parser that raises `UsageError`, with one line for each mistake.

    `format_help` has all options. `print_help` leaves out rare ones.
    """

    def __init__(self, name: str = "", **options: Any) -> None:
        super().__init__(
            prog=f"gyrodrift {name}".rstrip(), formatter_class=HelpFormatter, allow_abbrev=False, **options
        )
        self._name = name
        self._rare: list[argparse.Action] = []

    def show_only(self, common: Iterable[str] | None) -> None:
        """Show these options in the help, and all with --help-all; None for all but those of `help columns`."""
        shown = None if common is None else {"-h", "--help-all", "--quiet", *common}
        options = [action for action in self._actions if action.option_strings]
        names = [set(action.option_strings) for action in options]
        self._rare = [
            action
            for action, given in zip(options, names, strict=True)
            if (given.isdisjoint(shown) if shown is not None else given & COLUMN_OPTIONS)
        ]
        if self._rare:
            self.add_argument("--help-all", action=HelpAll, help=f"show {len(self._rare)} more options, too")

    def print_help(self, file: Any = None) -> None:
        """Print the help without rare options."""
        texts = [action.help for action in self._rare]
        for action in self._rare:
            action.help = argparse.SUPPRESS
        super().print_help(file)
        for action, text in zip(self._rare, texts, strict=True):
            action.help = text

    def read(self, words: Sequence[str]) -> argparse.Namespace:
        """Parse a command line.

        Raises
        ------
        UsageError
            With all unknown options, or else with the first mistake.
        """
        words = [self._present(word) for word in words]
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

    def _present(self, word: str) -> str:
        """A word with the present name of a deprecated option that this command has."""
        name, equals, value = word.partition("=")
        options = self._option_string_actions
        if name in DEPRECATED and name not in options and DEPRECATED[name].successor in options:
            return f"{successor_of(name)}{equals}{value}"
        return word

    def _mistake(self, word: str) -> str:
        options = self._option_string_actions
        if word in options:
            return ""
        sought = f"-{word}" if re.fullmatch(r"-\w", word) else word
        meant = begun_or_near(sought, [option for option in options if option.startswith("--")])
        return f"{word}: {self._name or 'gyrodrift'} has no such option; {meant or self._see}"

    def _get_value(self, action: argparse.Action, arg_string: str) -> Any:
        """Report a refused value with its option and the expected value."""
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
    """Words that can only be options."""
    for word in words:
        if word == "--":
            return
        if word.startswith("-") and word != "-" and not NUMBER.match(word):
            yield word
