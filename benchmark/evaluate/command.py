"""The command: measure the parts, print their figures beside the last ones, and say what became worse."""

import argparse
import sys
from collections.abc import Sequence
from dataclasses import replace
from datetime import UTC, datetime
from hashlib import sha256
from pathlib import Path

from evaluate.last import LAST, Measured, all_worse, read_last, table, write_last
from evaluate.parts import PARTS

ROOT = Path(__file__).resolve().parent.parent.parent
CODE = (
    "gyrodrift",
    "firmware_sim",
    "benchmark/gyrogap",
    "benchmark/blind",
    "benchmark/evaluate",
    "benchmark/simulators",
)


def main(argv: Sequence[str] | None = None) -> int:
    """0 where nothing became worse, 1 where a figure did, 130 interrupted."""
    arguments = _parser().parse_args(argv)
    last = read_last(arguments.last)
    try:
        now = {name: _measured(name, last.get(name), arguments) for name in arguments.parts or PARTS}
    except KeyboardInterrupt:
        print("evaluate: interrupted; the same command goes on from here", file=sys.stderr)
        return 130
    if arguments.update:
        write_last(last | now, arguments.last)
    worse = all_worse(last, now)
    for name in worse:
        print(f"evaluate: worse than the last figure by more than the margin: {name}", file=sys.stderr)
    return 1 if worse else 0


def _parser() -> argparse.ArgumentParser:
    about = "\n".join(f"  {name:12}{part.about} ({part.count})" for name, part in PARTS.items())
    parser = argparse.ArgumentParser(
        prog="python -m benchmark evaluate",
        description=f"{__doc__}\n\nparts, with the cases of each where no figures are committed:\n{about}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("parts", nargs="*", type=_part, metavar="PART", help="which (all)")
    parser.add_argument("--count", type=int, help="cases of each kind (as the committed figures have)")
    parser.add_argument("--seed", type=int, help="draw other cases (those of the committed figures)")
    parser.add_argument("--out", type=Path, default=ROOT / ".evaluate", help="folder of what is kept (.evaluate)")
    parser.add_argument("--last", type=Path, default=LAST, help="the committed figures (benchmark/evaluate/last.json)")
    parser.add_argument("--update", action="store_true", help="write the figures into the committed ones")
    return parser


def _part(name: str) -> str:
    if name not in PARTS:
        raise argparse.ArgumentTypeError(f"there is no part {name}; there are {', '.join(PARTS)}")
    return name


def _measured(name: str, last: Measured | None, arguments: argparse.Namespace) -> Measured:
    """Figures of one part; prints its table."""
    asked = _asked(name, last, arguments)
    folder = arguments.out / code_hash() / f"{name}-{asked.seed}-{asked.count}"
    figures = PARTS[name].measure(
        asked.seed, asked.count, folder, lambda text: print(text, file=sys.stderr, flush=True)
    )
    now = replace(asked, figures=tuple(figures))
    print(f"\n{name}: {PARTS[name].about}: {now.count}, seed {now.seed}")
    print("\n".join(table(now, last)), flush=True)
    return now


def _asked(name: str, last: Measured | None, arguments: argparse.Namespace) -> Measured:
    """Of which cases: as the options say, else as the committed figures, else as the part has it."""
    usual = last or PARTS[name]
    seed = usual.seed if arguments.seed is None else arguments.seed
    count = usual.count if arguments.count is None else arguments.count
    return Measured(datetime.now(UTC).date().isoformat(), seed, count, ())


def code_hash() -> str:
    """Of all code that a figure depends on: results of another version are not gone on from."""
    found = sha256()
    for path in sorted(path for folder in CODE for path in (ROOT / folder).rglob("*.py")):
        found.update(str(path.relative_to(ROOT)).encode() + path.read_bytes())
    return found.hexdigest()[:12]
