"""Outputs as a person asks for them, in the config or with `--output`: checked, with every mistake told."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields
from typing import Any, get_args, get_type_hints

from pydantic import ValidationError, create_model

from gyrodrift.config.explain import Strict, expectation, said, unknown_key
from gyrodrift.config.yaml import Key, plain_value
from gyrodrift.errors import UsageError
from gyrodrift.outputs.options import OutputSpec, about
from gyrodrift.outputs.registry import OUTPUTS

MOST_OUTPUTS = 100
"""Of a config; each has a thread or a socket of its own."""

Report = Callable[[Key, str], None]
"""Called with the key of what is wrong, within an output, and what is wrong with it."""


def outputs_in(given: Any, report: Report) -> tuple[OutputSpec, ...]:
    """Of the value of `outputs:`, a list of blocks with a name; the same output with the same options counts once."""
    if given is None:
        return ()
    if not isinstance(given, list):
        report((), f"is {said(given)}; expected a list of blocks such as - {{name: tcp}}")
        return ()
    if len(given) > MOST_OUTPUTS:
        report((), f"are {len(given)}; expected no more than {MOST_OUTPUTS}")
        return ()
    found = [output_in(each, _within(number, report)) for number, each in enumerate(given)]
    return tuple(dict.fromkeys(spec for spec in found if spec is not None))


def _within(number: int, report: Report) -> Report:
    return lambda key, what: report((number, *key), what)


def output_in(given: Any, report: Report) -> OutputSpec | None:
    """Of one block; None where it has mistakes."""
    if not isinstance(given, Mapping) or "name" not in given:
        report((), f"is {said(given)}; expected a block with a name: {', '.join(OUTPUTS)}")
        return None
    name, options = given["name"], {key: value for key, value in given.items() if key != "name"}
    if not isinstance(name, str) or name not in OUTPUTS:
        report(("name",), f"{said(name)} {unknown_key(str(name), list(OUTPUTS), 'an output')}")
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
    given: dict[str, Any] = {"name": name}
    problems: list[str] = []
    for word in filter(None, rest.split(",")):
        key, equals, text = word.partition("=")
        if not equals:
            problems.append(f"{word!r}: expected key=value")
            continue
        given[key] = text
    if name in OUTPUTS:
        given |= {key: _read(name, key, text) for key, text in given.items() if key != "name"}

    def report(key: Key, what: str) -> None:
        problems.append(f"{'.'.join(map(str, key))}: {what}" if key and key != ("name",) else what)

    spec = output_in(given, report)
    if problems or spec is None:
        raise UsageError("\n".join(f"--output {argument}: {problem}" for problem in problems))
    return spec


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
            else:
                expected = expectation(str(key), model.model_fields[str(key)])
                report((str(key),), f"is {said(given[str(key)])}; expected {expected}")
        return None
    return OutputSpec(name, options(**content))


def _read(name: str, key: str, text: str) -> Any:
    """A value of the command line: text where the option is text, else as a config would read it."""
    hints = get_type_hints(OUTPUTS[name].output.options_type)
    kinds = get_args(hints.get(key)) or (hints.get(key),)
    return text if str in kinds else plain_value(text)
