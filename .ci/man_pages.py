"""Manual pages from the parsers of the commands and from the registries: `python .ci/man_pages.py FOLDER`.

One page for the program, one for each command, and `gyrodrift-config.5` for the config.
"""

import argparse
import os
import re
import sys
from collections.abc import Iterator
from dataclasses import fields
from pathlib import Path
from typing import Any

from gyrodrift import __version__
from gyrodrift.cli import COMMANDS, parser_of, program_parser
from gyrodrift.cli.parser import HelpFormatter, Parser
from gyrodrift.config.model import SLEW
from gyrodrift.config.outputs import options_help
from gyrodrift.filters.registry import FILTERS
from gyrodrift.firmware.parameters import bound_checks
from gyrodrift.outputs.registry import OUTPUTS

CONFIG = "gyrodrift-config"
KEYS = {
    "filter": "name of the filter; without it, the first block of a filter chooses it",
    "sample_rate_hz": "sample rate that the parameters were tuned at, Hz",
    SLEW: "speed at which smooth_yaw_deg takes corrections in, deg/s",
    "provenance": "block that tune writes: where the parameters come from",
    "outputs": "list of outputs, such as - {name: tcp, port: 8117}",
    "columns": "columns of a device that sends text, as --columns takes them",
    "send": "text that is sent to the device after its port was opened",
    "axes": "axes of the filter: auto, 1 or 3",
    "mount": "mount of the sensor, such as {up: +z, forward: +x}",
    "calibration": "block that calibrate writes: bias, scale, sign and noise of the device",
    "sources": "blocks NAME: {port: ...} of several gyros; each has the keys of this page",
}
"""Keys at the top of a config; a test compares them with those that the config reader knows."""


def pages() -> dict[str, str]:
    """Text of each manual page by the name of its file; lines are as wide as in a terminal of 80 columns."""
    os.environ["COLUMNS"] = "80"
    texts = {"gyrodrift.1": _program()}
    texts |= {f"gyrodrift-{name}.1": _command(name, parser_of(name)) for name in COMMANDS}
    return texts | {f"{CONFIG}.5": _config()}


def release_date() -> str:
    """Date of the version in the changelog; empty for a version that is not released."""
    changelog = (Path(__file__).parent.parent / "docs" / "CHANGELOG.md").read_text(encoding="utf-8")
    match = re.search(rf"^## {re.escape(__version__)} — (\S+)$", changelog, re.MULTILINE)
    return match[1] if match else ""


def roff(text: str) -> str:
    """Text with the characters escaped that roff would take as its own."""
    escaped = text.replace("\\", r"\e").replace("-", r"\-").replace("'", r"\(aq").replace("`", r"\(ga")
    return re.sub(r"^([.'])", r"\\&\1", escaped, flags=re.MULTILINE)


def _head(name: str, section: int, what: str) -> list[str]:
    title = f'.TH "{name.upper()}" "{section}" "{release_date()}" "gyrodrift {__version__}" "gyrodrift"'
    return [title, ".SH NAME", rf"{roff(name)} \- {roff(what)}"]


def _program() -> str:
    parser = program_parser()
    lines = [*_head("gyrodrift", 1, "correct the yaw drift of a low-cost gyro in real time"), ".SH SYNOPSIS"]
    lines += [".B gyrodrift", roff("COMMAND ..."), ".SH COMMANDS"]
    for name, what in COMMANDS.items():
        lines += [".TP", rf"\fBgyrodrift\-{roff(name)}\fR(1)", roff(what)]
    lines += [*_options(parser), *_epilog(parser), ".SH SEE ALSO", rf"\fB{roff(CONFIG)}\fR(5)"]
    return "\n".join(lines) + "\n"


def _command(name: str, parser: Parser) -> str:
    usage = parser.format_usage().removeprefix("usage: ")
    lines = [*_head(f"gyrodrift-{name}", 1, COMMANDS[name]), ".SH SYNOPSIS", *_verbatim(usage), ".SH DESCRIPTION"]
    for number, paragraph in enumerate(re.split(r"\n\s*\n", parser.description or "")):
        is_table = any(line.startswith(" ") for line in paragraph.splitlines())
        lines += [*([".PP"] if number else []), *(_verbatim(paragraph) if is_table else [roff(paragraph.strip())])]
    lines += [*_options(parser), *_epilog(parser), ".SH SEE ALSO"]
    return "\n".join([*lines, rf"\fBgyrodrift\fR(1), \fB{roff(CONFIG)}\fR(5)"]) + "\n"


def _verbatim(text: str) -> list[str]:
    return [".nf", roff(text.rstrip("\n")), ".fi"]


def _options(parser: Parser) -> Iterator[str]:
    formatter = HelpFormatter(parser.prog)
    for title, is_wanted in (("ARGUMENTS", False), ("OPTIONS", True)):
        actions = [a for a in parser._actions if bool(a.option_strings) is is_wanted and a.help != argparse.SUPPRESS]  # noqa: SLF001 - argparse has no public list
        if actions:
            yield f".SH {title}"
        for action in actions:
            yield ".TP"
            yield rf"\fB{roff(formatter._format_action_invocation(action))}\fR"  # noqa: SLF001 - as in the help
            yield roff(formatter._expand_help(action) if action.help else "")  # noqa: SLF001 - likewise


def _epilog(parser: Parser) -> list[str]:
    examples, _, notes = (parser.epilog or "").partition("\n\n")
    lines = [".SH EXAMPLES", *_verbatim(examples.removeprefix("examples:\n"))]
    return [*lines, ".SH NOTES", *_verbatim(notes)] if notes.strip() else lines


def _config() -> str:
    lines = [*_head(CONFIG, 5, "config of gyrodrift serve, filter, tune and compare"), ".SH DESCRIPTION"]
    lines += [roff("YAML. Every key is optional. serve follows the file while it runs; a file with mistakes changes")]
    lines += [roff("nothing, and each mistake is reported with its line."), ".SH KEYS"]
    for key, meaning in KEYS.items():
        lines += [".TP", rf"\fB{roff(key)}\fR", roff(meaning)]
    for name, kind in FILTERS.own.items():
        lines += [f".SH BLOCK {roff(name)}"]
        bounds = dict(zip((field.name for field in fields(kind.params)), _bounds(kind.params), strict=True))
        for parameter in kind.parameters:
            default = getattr(kind.params(), parameter.name)
            lines += [".TP", rf"\fB{roff(parameter.name)}\fR"]
            lines += [roff(f"{parameter.line} (default {default:g}; {bounds[parameter.name]})")]
    for name, output in OUTPUTS.own.items():
        lines += [f".SH OUTPUT {roff(name)}", roff(output.help)]
        for option, default, meaning in options_help(name):
            lines += [".TP", rf"\fB{roff(option)}\fR={roff(default)}", roff(meaning)]
    return "\n".join([*lines, ".SH SEE ALSO", r"\fBgyrodrift\-serve\fR(1)"]) + "\n"


def _bounds(params: type[Any]) -> Iterator[str]:
    for check in bound_checks(params):
        yield re.sub(r"GD_R\(([^)]*)\)", r"\1", check).replace("p->", "").replace(" && ", ", ")


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for file, text in pages().items():
        (folder / file).write_text(text, encoding="utf-8")
