"""Run the same filter that serve runs over a recorded session, and write every column of its recursion as CSV.

Columns: t_s, rate_dps, lpf_dps, i_dps, omega_dps, omega_d_dps, yaw_deg. Samples whose time does not advance or
whose rate is not finite are left out and counted. Without --config the published parameters are used.
"""

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from gyrodrift.filter import HdrParams, HdrState, coefficients, step

if TYPE_CHECKING:
    from gyrodrift.session.session import Session

HEADER = "t_s,rate_dps,lpf_dps,i_dps,omega_dps,omega_d_dps,yaw_deg"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("session", type=Path, metavar="SESSION", help="recorded session (.mcap or .csv)")
    parser.add_argument("--config", type=Path, metavar="FILE", help="YAML with hdr: parameters")
    parser.add_argument("--out", type=Path, metavar="FILE.csv", help="where to write (default: stdout)")


def run(arguments: argparse.Namespace) -> int:
    """Filter the session; 0 when it is written."""
    from gyrodrift.config import Config, load_config
    from gyrodrift.files import write_whole
    from gyrodrift.session.session import load_session

    config = load_config(arguments.config) if arguments.config else Config()
    session = load_session(arguments.session)
    state = HdrState()
    lines = csv_lines(session, config.hdr, state)
    if arguments.out is None:
        sys.stdout.writelines(lines)
        sys.stdout.flush()
    else:
        write_whole(arguments.out, lines)
    if state.rejected:
        print(f"gyrodrift: {session.name}: {state.rejected} samples passed by (time or rate)", file=sys.stderr)
    return 0


def csv_lines(session: "Session", params: HdrParams, state: HdrState) -> Iterator[str]:
    """The header and a line for each accepted sample, every float with all its digits."""
    yield f"{HEADER}\n"
    c = coefficients(params)
    for t_s, rate_dps in zip(session.t_device_s.tolist(), session.rate_dps.tolist(), strict=True):
        if step(c, state, t_s, rate_dps):
            yield (
                f"{t_s!r},{rate_dps!r},{state.lpf_dps!r},{state.i_dps!r},"
                f"{state.omega_dps!r},{state.omega_d_dps!r},{state.yaw_deg!r}\n"
            )
