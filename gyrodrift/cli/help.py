"""Show the help of a command, or list the commands. The topic columns explains the columns of text and tables."""

import argparse

from gyrodrift.cli import parser_of, program_parser
from gyrodrift.cli.options import columns_parser

EXAMPLES = """\
gyrodrift help
gyrodrift help serve
gyrodrift help columns
"""

COLUMNS = "columns"
"""Topic that is no command."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument(
        "topic", nargs="?", metavar="COMMAND", help="which one, or columns (default: all of them, a line each)"
    )


def run(arguments: argparse.Namespace) -> int:
    """Print the help; returns 0."""
    if arguments.topic == COLUMNS:
        columns_parser().print_help()
    else:
        (parser_of(arguments.topic) if arguments.topic else program_parser()).print_help()
    return 0
