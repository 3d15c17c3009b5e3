"""Run the same filter that serve runs over a recorded session, and write every column of its recursion as CSV.

Samples whose time does not advance or whose rate is not finite are left out and counted. Columns are t_s and rate_dps,
and then
"""

import argparse
import sys
from collections.abc import Iterator
from operator import attrgetter
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gyrodrift.cli import options
from gyrodrift.filters.registry import FILTERS

if TYPE_CHECKING:
    from gyrodrift.filters.filter import Filter, FilterState
    from gyrodrift.session.session import Session


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    columns = [f"  with {name}: {', '.join(known.columns)}" for name, known in FILTERS.items()]
    parser.description = "\n".join([f"{parser.description}".rstrip(), *columns])
    parser.add_argument("session", type=Path, metavar="SESSION", help="recorded session (.mcap or .csv)")
    options.add_filter_options(parser, "YAML with a filter and its parameters")
    parser.add_argument("--out", type=Path, metavar="FILE.csv", help="where to write (default: stdout)")
    options.add_force_option(parser)


def run(arguments: argparse.Namespace) -> int:
    """Filter the session; 0 when it is written."""
    from gyrodrift.files import check_kept, write_whole
    from gyrodrift.session.files import load_session

    if arguments.out is not None:
        inputs = [arguments.session, *([arguments.config] if arguments.config else [])]
        check_kept([arguments.out], inputs, force=arguments.force)
    chosen, params = options.chosen_filter(arguments)
    session = load_session(arguments.session)
    state: FilterState = chosen.state()
    lines = csv_lines(session, chosen, params, state)
    if arguments.out is None:
        sys.stdout.writelines(lines)
        sys.stdout.flush()
    else:
        write_whole(arguments.out, lines)
    if state.rejected:
        print(f"gyrodrift: {session.name}: {state.rejected} samples passed by (time or rate)", file=sys.stderr)
    return 0


def csv_lines(session: "Session", chosen: "Filter", params: Any, state: "FilterState") -> Iterator[str]:
    """The header and a line for each accepted sample, every float with all its digits."""
    yield f"{','.join(['t_s', 'rate_dps', *chosen.columns])}\n"
    columns, step, c = attrgetter(*chosen.columns), chosen.step, chosen.coefficients(params)
    for t_s, rate_dps in zip(session.t_device_s.tolist(), session.rate_dps.tolist(), strict=True):
        if step(c, state, t_s, rate_dps):
            yield f"{','.join(map(repr, (t_s, rate_dps, *columns(state))))}\n"
