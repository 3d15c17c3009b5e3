"""Outputs from the config or from `--output`, checked, with all mistakes."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import fields
from typing import Any, get_args, get_type_hints

from firmware_sim.plain_value import Key, plain_value
from gyrodrift.config.explain import Hint, accepted, describe_value, expectation, field_of, unknown_key
from gyrodrift.outputs.options import OutputSpec, about, secrets
from gyrodrift.outputs.registry import OUTPUTS
from gyrodrift.values.errors import UsageError
from gyrodrift.values.secret import HIDDEN, SecretText, shown_key, without_secrets

MOST_OUTPUTS = 100
"""Outputs of a config; each has a thread or a socket."""

Report = Callable[[Key, str], None]
"""Called with the key of a mistake, within an output, and with the message."""

MOST_WORDS = 100
"""Options in an argument of `--output`; no output has a tenth of them."""


def outputs_in(value: Any, report: Report) -> tuple[OutputSpec, ...]:
    """Outputs from the value of `outputs:`, a list of blocks with a name; duplicates count once."""
    if value is None:
        return ()
    if not isinstance(value, list):
        report((), f"{_describe_block(value)}; expected a list of blocks such as - {{name: tcp}}")
        return ()
    if len(value) > MOST_OUTPUTS:
        report((), f"are {len(value)}; expected no more than {MOST_OUTPUTS}")
        return ()
    specs = [output_in(block, _within(index, report)) for index, block in enumerate(value)]
    return tuple(dict.fromkeys(spec for spec in specs if spec is not None))


def _within(index: int, report: Report) -> Report:
    return lambda key, message: report((index, *key), message)


def _describe_block(given: Any) -> str:
    """Description of a value where a block is expected; text is not shown, as it may be a misplaced password."""
    return "is text" if isinstance(given, str) and given not in OUTPUTS else f"is {describe_value(given)}"


def output_in(given: Any, report: Report) -> OutputSpec | None:
    """Output from a block; None if it has mistakes, which are reported."""
    if not isinstance(given, Mapping) or "name" not in given:
        report((), f"{_describe_block(given)}; expected a block with a name: {', '.join(OUTPUTS)}")
        return None
    name, options = given["name"], {key: value for key, value in given.items() if key != "name"}
    if not isinstance(name, str) or name not in OUTPUTS:
        shown = shown_key(name) if isinstance(name, str) else name
        report(("name",), f"{describe_value(shown)} {unknown_key(str(name), list(OUTPUTS), 'an output')}")
        return None
    try:
        OUTPUTS[name].check_packages()
    except UsageError as error:
        report(("name",), str(error))
        return None
    return _checked(name, options, report)


def output_of(argument: str) -> OutputSpec:
    """Output from an argument `NAME[:key=value,...]` of `--output`.

    Raises
    ------
    UsageError
        With all mistakes.
    """
    name, _, rest = argument.partition(":")
    words = [word for word in rest.split(",") if word]
    if len(words) > MOST_WORDS:
        raise UsageError(f"--output {shown_key(name)}: has {len(words)} options, more than any output has")
    given: dict[str, Any] = {"name": name}
    problems: list[str] = []
    for word in words:
        key, equals, text = word.partition("=")
        is_public = _is_public(name, given.keys() - {"name"}) and not _has_user(rest)
        if equals and (is_public or key in _keys(name)):
            given[key] = text
        elif is_public:
            problems.append(f"{word!r}: expected key=value")
        else:  # the word may be part of a password
            problems.append("expected key=value after a comma; put a password with a comma into a file")
    if name in OUTPUTS:
        given |= {key: _read(name, key, text) for key, text in given.items() if key != "name"}

    def report(key: Key, message: str) -> None:
        problems.append(f"{'.'.join(map(str, key))}: {message}" if key and key != ("name",) else message)

    spec = output_in(given, report)
    if problems or spec is None:
        shown = _shown(argument)
        raise UsageError("\n".join(f"--output {shown}: {problem}" for problem in problems))
    return spec


def _is_public(name: str, keys: Iterable[str]) -> bool:
    """Whether none of these options can be a secret, with misspelled names taken as secrets."""
    if name not in OUTPUTS:
        return not any(keys)
    hidden = secrets(OUTPUTS[name].output.options_type)
    return not hidden or _keys(name) - hidden >= set(keys)


def _keys(name: str) -> frozenset[str]:
    """Option names of an output; empty for an unknown output."""
    return (
        frozenset(field.name for field in fields(OUTPUTS[name].output.options_type)) if name in OUTPUTS else frozenset()
    )


def _shown(argument: str) -> str:
    """An argument of `--output` with `***` for each value that may be a secret."""
    name, colon, rest = argument.partition(":")
    words = [word.partition("=") for word in rest.split(",")]
    has_user = _has_user(rest)
    if has_user or not _is_public(name, (key for key, _, _ in words if key)):
        public = [_is_public(name, [key]) and not (has_user and {":", "@"} & set(text)) for key, _, text in words]
        pairs = [
            (key, text if is_public else HIDDEN)
            for is_public, (key, equals, text) in zip(public, words, strict=True)
            if equals
        ]
        rest = ",".join(f"{key}={text}" for key, text in pairs)
    return without_secrets(f"{shown_key(name)}{colon}{rest}")


def _has_user(value: Any) -> bool:
    """Whether a value may be an address with user and password, `ann:password@host`."""
    return isinstance(value, str) and ":" in value.rpartition("@")[0]


def options_help(name: str) -> Sequence[tuple[str, str, str]]:
    """Name, default, and meaning with accepted values of each option of an output."""
    options = OUTPUTS[name].output.options_type
    notes, hints = about(options), _fields_of(options)
    return [
        (
            field.name,
            "" if field.default is None or field.default == "" else str(field.default),
            f"{notes[field.name]} ({expectation(field.name, hints[field.name])})",
        )
        for field in fields(options)
    ]


def _fields_of(options: type[Any]) -> dict[str, Hint]:
    """Types and bounds of an output's options, by name."""
    hints = get_type_hints(options, include_extras=True)
    return {field.name: field_of(hints[field.name]) for field in fields(options)}


def _checked(name: str, given: Mapping[str, Any], report: Report) -> OutputSpec | None:
    options = OUTPUTS[name].output.options_type
    option_fields = _fields_of(options)
    values: dict[str, Any] = {}
    for key in option_fields.keys() & given.keys():
        with suppress(ValueError):
            values[key] = accepted(given[key], option_fields[key])
    wrong = [key for key in (*option_fields, *given) if key in given and key not in values]
    for key in dict.fromkeys(wrong):
        report((str(key),), _explained(name, key, given[key], option_fields))
    return None if wrong else OutputSpec(name, options(**values))


def _explained(name: str, key: str, value: Any, option_fields: Mapping[str, Hint]) -> str:
    """Message for an option that an output does not have, or does not accept."""
    if key not in option_fields:
        return unknown_key(str(key), list(option_fields), f"an option of {name}")
    is_hidden = key in secrets(OUTPUTS[name].output.options_type) or _has_user(value)
    shown = "not shown" if is_hidden else describe_value(value)
    return f"is {shown}; expected {expectation(key, option_fields[key])}"


def _read(name: str, key: str, text: str) -> Any:
    """A value of the command line: text for a text option, otherwise read as in a config."""
    hints = get_type_hints(OUTPUTS[name].output.options_type)
    kinds = get_args(hints.get(key)) or (hints.get(key),)
    return text if {str, SecretText} & set(kinds) else plain_value(text)
