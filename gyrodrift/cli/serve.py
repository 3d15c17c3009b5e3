"""Read a gyro on a serial port or a source, correct its drift, and print yaw until SIGINT or SIGTERM.

On a terminal one line shows yaw, bias, rest and link. In a pipe, or with --json, stdout gets a JSON line per sample:
seq, t_s (device clock, s), rate_dps (as measured), corrected_dps, yaw_deg, bias_dps. The filter restlevel adds
yaw_sigma_deg and confidence; encoder_deg and temp_c are there when the device sends them. The log goes to stderr.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gyrodrift.cli import numbers, options
from gyrodrift.io.terminal import is_screen

if TYPE_CHECKING:
    from gyrodrift.config.watch import ConfigWatch
    from gyrodrift.outputs.options import OutputSpec


class ListOutputs(argparse.Action):
    """Print every output with its options, and end."""

    def __init__(self, option_strings: Sequence[str], dest: str, **words: Any) -> None:
        super().__init__(option_strings, dest, nargs=0, **words)

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        """Print the list."""
        from gyrodrift.config.outputs import options_help
        from gyrodrift.io.installation import extra_command
        from gyrodrift.outputs.registry import OUTPUTS

        for name, kind in OUTPUTS.items():
            needs = f" (needs {extra_command(kind.extra)})" if kind.extra else ""
            print(f"{name}: {kind.help}{needs}")
            for option, default, meaning in options_help(name):
                print(f"  {option}={default}: {meaning}")
        for problem in OUTPUTS.problems():
            print(f"gyrodrift: {problem}", file=sys.stderr)
        parser.exit()


EXAMPLES = """\
gyrodrift serve --port auto
gyrodrift serve --port /dev/ttyUSB0 --config my.yaml --rate 10
gyrodrift serve --port /dev/ttyUSB0 --record sessions --rotate 1h > yaw.jsonl
"""


COMMON = (
    "--port",
    "--config",
    "--filter",
    "--output",
    "--list-outputs",
    "--record",
    "--memory",
    "--control",
    "--rate",
    "--json",
    "--columns",
)
"""Options in the short help."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    options.add_link_options(parser, needs_port=False)
    options.add_filter_options(parser, "YAML with a filter and its parameters; followed while serve runs")
    parser.add_argument(
        "--json",
        action="store_true",
        help="print JSON lines on a terminal, too, in place of one line with the state (default: only in a pipe)",
    )
    parser.add_argument(
        "--rate", type=numbers.number(1e6), metavar="HZ", help="at most HZ lines a second of device time (default: all)"
    )
    parser.add_argument(
        "--record", type=Path, metavar="DIR", help="record the device into this folder too (default: none)"
    )
    parser.add_argument(
        "--output",
        action="append",
        default=[],
        metavar="NAME[:KEY=VALUE,...]",
        help="send samples to this output too; repeatable; --list-outputs prints names and keys (default: none)",
    )
    parser.add_argument("--list-outputs", action=ListOutputs, help="print the outputs with their options, and end")
    parser.add_argument(
        "--control",
        type=Path,
        metavar="PATH",
        help="unix socket through which this user controls the service: gyrodrift ctl, top, and the buttons of the "
        "live page (default: none)",
    )
    parser.add_argument(
        "--memory",
        type=Path,
        metavar="FILE",
        help="keep what the filter learned about the device in this file across restarts; from a recording (.mcap) the "
        "filter takes its initial state, and the file stays as it is (default: none)",
    )
    options.add_recording_options(parser)
    options.add_log_options(parser)


def run(arguments: argparse.Namespace) -> int:
    """Run until a signal comes; exit status 0."""
    numbers.rotation(arguments.rotate)
    if arguments.port is None:
        from gyrodrift.cli import serve_several

        return serve_several.run(arguments)
    baud = numbers.baud(arguments.baud)
    specs = _outputs(arguments.output)
    watch = _watch(arguments.config)
    from gyrodrift.cli.serving import serve

    serve(arguments, baud, watch, specs, has_person=_has_person(arguments))
    return 0


def _watch(path: Path | None) -> "ConfigWatch | None":
    """The config of `--config`, followed from now on."""
    if path is None:
        return None
    from gyrodrift.config.watch import ConfigWatch

    return ConfigWatch(path)


def _has_person(arguments: argparse.Namespace) -> bool:
    """Whether a person reads stdout, and not a program."""
    return is_screen(sys.stdout) and not arguments.json


def _outputs(texts: list[str]) -> "list[OutputSpec]":
    """Outputs of `--output`; their checker is loaded only if there are any."""
    if not texts:
        return []
    from gyrodrift.config.outputs import output_of

    return [output_of(text) for text in texts]
