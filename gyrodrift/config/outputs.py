"""Outputs as a person asks for them, in the config or with `--output`: checked, with every mistake told."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import fields
from typing import Any, get_args, get_type_hints

from pydantic import ValidationError, create_model

from gyrodrift.config.explain import Strict, expectation, said, unknown_key
from gyrodrift.config.yaml import Key, plain_value
from gyrodrift.errors import UsageError
from gyrodrift.outputs.options import OutputSpec, about, secrets
from gyrodrift.outputs.registry import OUTPUTS
from gyrodrift.secret import HIDDEN, SecretText, shown_key, without_secrets

MOST_OUTPUTS = 100
"""Of a config; each has a thread or a socket of its own."""

Report = Callable[[Key, str], None]
"""Called with the key of what is wrong, within an output, and what is wrong with it."""

MOST_WORDS = 100
"""Of an argument of `--output`: some times as many as any output has options."""


def outputs_in(given: Any, report: Report) -> tuple[OutputSpec, ...]:
    """Of the value of `outputs:`, a list of blocks with a name; the same output with the same options counts once."""
    if given is None:
        return ()
    if not isinstance(given, list):
        report((), f"{_said_of(given)}; expected a list of blocks such as - {{name: tcp}}")
        return ()
    if len(given) > MOST_OUTPUTS:
        report((), f"are {len(given)}; expected no more than {MOST_OUTPUTS}")
        return ()
    found = [output_in(each, _within(number, report)) for number, each in enumerate(given)]
    return tuple(dict.fromkeys(spec for spec in found if spec is not None))


def _within(number: int, report: Report) -> Report:
    return lambda key, what: report((number, *key), what)


def _said_of(given: Any) -> str:
    """What stands in the place of a block; text but the name of an output may be a misplaced password."""
    return "is text" if isinstance(given, str) and given not in OUTPUTS else f"is {said(given)}"


def output_in(given: Any, report: Report) -> OutputSpec | None:
    """Of one block; None where it has mistakes."""
    if not isinstance(given, Mapping) or "name" not in given:
        report((), f"{_said_of(given)}; expected a block with a name: {', '.join(OUTPUTS)}")
        return None
    name, options = given["name"], {key: value for key, value in given.items() if key != "name"}
    if not isinstance(name, str) or name not in OUTPUTS:
        shown = shown_key(name) if isinstance(name, str) else name
        report(("name",), f"{said(shown)} {unknown_key(str(name), list(OUTPUTS), 'an output')}")
        return None
    try:
        OUTPUTS[name].check_packages()
    except UsageError as error:
        report(("name",), str(error))
        return None
    return _checked(name, options, report)


def output_of(argument: str) -> OutputSpec:
    """Of `--output NAME[:key=value,...]`.

    Raises
    ------
    UsageError
        With every mistake.
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
        else:  # it may be a part of the password
            problems.append("expected key=value behind a comma; a password with a comma goes into a file")
    if name in OUTPUTS:
        given |= {key: _read(name, key, text) for key, text in given.items() if key != "name"}

    def report(key: Key, what: str) -> None:
        problems.append(f"{'.'.join(map(str, key))}: {what}" if key and key != ("name",) else what)

    spec = output_in(given, report)
    if problems or spec is None:
        shown = _shown(argument)
        raise UsageError("\n".join(f"--output {shown}: {problem}" for problem in problems))
    return spec


def _is_public(name: str, keys: Iterable[str]) -> bool:
    """Whether none of these options of an output may be a secret, slips in their names included."""
    if name not in OUTPUTS:
        return not any(keys)
    hidden = secrets(OUTPUTS[name].output.options_type)
    return not hidden or _keys(name) - hidden >= set(keys)


def _keys(name: str) -> frozenset[str]:
    """The options of an output; none where there is no such output."""
    return (
        frozenset(each.name for each in fields(OUTPUTS[name].output.options_type)) if name in OUTPUTS else frozenset()
    )


def _shown(argument: str) -> str:
    """The argument of `--output` with `***` for every value that may be a secret."""
    name, colon, rest = argument.partition(":")
    words = [word.partition("=") for word in rest.split(",")]
    has_user = _has_user(rest)
    if has_user or not _is_public(name, (key for key, _, _ in words if key)):
        public = [_is_public(name, [key]) and not (has_user and {":", "@"} & set(text)) for key, _, text in words]
        known = [
            (key, text if is_public else HIDDEN)
            for is_public, (key, equals, text) in zip(public, words, strict=True)
            if equals
        ]
        rest = ",".join(f"{key}={text}" for key, text in known)
    return without_secrets(f"{shown_key(name)}{colon}{rest}")


def _has_user(value: Any) -> bool:
    """Whether it may be an address with a user and a password in it, `ann:password@host`."""
    return isinstance(value, str) and ":" in value.rpartition("@")[0]


def options_help(name: str) -> Sequence[tuple[str, str, str]]:
    """Of each option of an output: its name, its default, and what it means and takes."""
    options = OUTPUTS[name].output.options_type
    notes, model = about(options), _model_of(options)
    return [
        (
            each.name,
            "" if each.default is None or each.default == "" else str(each.default),
            f"{notes[each.name]} ({expectation(each.name, model.model_fields[each.name])})",
        )
        for each in fields(options)
    ]


def _model_of(options: type[Any]) -> type[Strict]:
    """A model with the fields, bounds and defaults of an output's options."""
    hints = get_type_hints(options, include_extras=True)
    content: dict[str, Any] = {each.name: (hints[each.name], each.default) for each in fields(options)}
    return create_model(options.__name__, __base__=Strict, **content)


def _checked(name: str, given: Mapping[str, Any], report: Report) -> OutputSpec | None:
    options = OUTPUTS[name].output.options_type
    model = _model_of(options)
    try:
        content = model.model_validate(given).model_dump()
    except ValidationError as error:
        for key, problem in {problem["loc"][0]: problem for problem in error.errors(include_url=False)}.items():
            known = list(model.model_fields)
            if problem["type"] == "extra_forbidden":
                report((str(key),), unknown_key(str(key), known, f"an option of {name}"))
                continue
            expected = expectation(str(key), model.model_fields[str(key)])
            is_hidden = str(key) in secrets(options) or _has_user(given[str(key)])
            value = "not shown" if is_hidden else said(given[str(key)])
            report((str(key),), f"is {value}; expected {expected}")
        return None
    return OutputSpec(name, options(**content))


def _read(name: str, key: str, text: str) -> Any:
    """A value of the command line: text where the option is text, else as a config would read it."""
    hints = get_type_hints(OUTPUTS[name].output.options_type)
    kinds = get_args(hints.get(key)) or (hints.get(key),)
    return text if {str, SecretText} & set(kinds) else plain_value(text)
