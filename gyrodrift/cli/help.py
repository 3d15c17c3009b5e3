"""Show the help of a command, or list the commands."""

import argparse

from gyrodrift.cli import parser_of, program_parser

EXAMPLES = """\
gyrodrift help
gyrodrift help serve
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("topic", nargs="?", metavar="COMMAND", help="which one (default: all of them, a line each)")


def run(arguments: argparse.Namespace) -> int:
    """Print the help; returns 0."""
    (parser_of(arguments.topic) if arguments.topic else program_parser()).print_help()
    return 0
