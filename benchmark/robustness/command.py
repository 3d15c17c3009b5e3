"""The command line of the campaigns."""

import argparse
import multiprocessing
import sys
from functools import partial
from itertools import chain
from pathlib import Path


def main(argv: list[str] | None = None) -> int:
    """One of the campaigns; 0 where every promise held, 1 otherwise."""
    parser = argparse.ArgumentParser(prog="python -m benchmark robustness", description=__doc__)
    commands = parser.add_subparsers(required=True)
    faults = commands.add_parser("faults", help="every fault of the simulated device, alone and in pairs")
    faults.add_argument("--pairs", type=int, default=50, help="drawn for csv and witmotion each (default 50)")
    faults.add_argument("--seed", type=int, default=1, help="of pairs, noise and damage (default 1)")
    faults.add_argument("--jobs", type=int, help="at once (default: as many as there are processors)")
    faults.add_argument("--out", type=Path, help="write the whole table there, in Markdown")
    faults.set_defaults(act=_faults)
    soak = commands.add_parser("soak", help="hours of device time at 1 kHz, with reloads, reconnects and clients")
    soak.add_argument("--hours", type=float, default=24.0, help="of device time (default 24)")
    soak.add_argument("--minutes", type=float, default=float("inf"), help="of real time at most (default: no end)")
    soak.add_argument("--pace", type=float, default=float("inf"), help="1 is real time (default: as fast as it goes)")
    soak.set_defaults(act=_soak)
    overload = commands.add_parser("overload", help="too many samples, busy processors, stops, a clock that is set")
    overload.set_defaults(act=_overload)
    arguments = parser.parse_args(argv)
    broken: int = arguments.act(arguments)
    return 1 if broken else 0


def _faults(arguments: argparse.Namespace) -> int:
    from robustness import campaign  # noqa: PLC0415 - a campaign imports what it needs

    rows = []
    broken = 0
    runs = chain(campaign.single_runs(), campaign.paired_runs(arguments.pairs, arguments.seed))
    with multiprocessing.get_context("spawn").Pool(arguments.jobs) as pool:
        for row in pool.imap(partial(campaign.run_of, seed=arguments.seed), runs, chunksize=8):
            rows.append(row)
            for each in row.broken_promises():
                broken += 1
                print(f"broken: {row.protocol} {row.name}: {each}", flush=True)
            if sys.stderr.isatty():
                print(f"\r{len(rows)} runs, {broken} promises broken", end="", file=sys.stderr)
    whole = campaign.table(rows)
    if arguments.out is not None:
        arguments.out.write_text(f"{whole}\n")
    tables = (whole, campaign.by_fault(rows), campaign.summary(rows), f"{len(rows)} runs, {broken} promises broken")
    print("\n" + "\n\n".join(tables))
    return broken


def _soak(arguments: argparse.Namespace) -> int:
    from robustness.soak import soak  # noqa: PLC0415 - likewise

    result = soak(round(arguments.hours * 3600), arguments.minutes * 60, arguments.pace)
    broken = list(result.broken_promises())
    print("\n".join([result.text(), *(f"broken: {each}" for each in broken)]))
    return len(broken)


def _overload(_: argparse.Namespace) -> int:
    from robustness.overload import all_cases  # noqa: PLC0415 - likewise

    broken = 0
    for case in all_cases():
        result = case()
        print(result.text(), flush=True)
        broken += len(result.broken)
    return broken
