"""Outputs from the config or from `--output`, checked, with all mistakes."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import fields
from typing import Any, get_args, get_type_hints

from pydantic import ValidationError, create_model

from firmware_sim.strict_yaml import Key, plain_value
from gyrodrift.config.explain import Strict, describe_value, expectation, unknown_key
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
    notes, model = about(options), _model_of(options)
    return [
        (
            field.name,
            "" if field.default is None or field.default == "" else str(field.default),
            f"{notes[field.name]} ({expectation(field.name, model.model_fields[field.name])})",
        )
        for field in fields(options)
    ]


def _model_of(options: type[Any]) -> type[Strict]:
    """A model with the fields, bounds and defaults of an output's options."""
    hints = get_type_hints(options, include_extras=True)
    content: dict[str, Any] = {field.name: (hints[field.name], field.default) for field in fields(options)}
    return create_model(options.__name__, __base__=Strict, **content)


def _checked(name: str, given: Mapping[str, Any], report: Report) -> OutputSpec | None:
    options = OUTPUTS[name].output.options_type
    model = _model_of(options)
    try:
        content = model.model_validate(given).model_dump()
    except ValidationError as error:
        for key, problem in {problem["loc"][0]: problem for problem in error.errors(include_url=False)}.items():
            names = list(model.model_fields)
            if problem["type"] == "extra_forbidden":
                report((str(key),), unknown_key(str(key), names, f"an option of {name}"))
                continue
            expected = expectation(str(key), model.model_fields[str(key)])
            is_hidden = str(key) in secrets(options) or _has_user(given[str(key)])
            value = "not shown" if is_hidden else describe_value(given[str(key)])
            report((str(key),), f"is {value}; expected {expected}")
        return None
    return OutputSpec(name, options(**content))


def _read(name: str, key: str, text: str) -> Any:
    """A value of the command line: text for a text option, otherwise read as in a config."""
    hints = get_type_hints(OUTPUTS[name].output.options_type)
    kinds = get_args(hints.get(key)) or (hints.get(key),)
    return text if {str, SecretText} & set(kinds) else plain_value(text)
