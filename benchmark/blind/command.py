"""The command line of the blind check."""

import argparse
import json
import sys
from pathlib import Path

from gyrogap.json_files import write_json
from gyrogap.seals import BrokenSealError
from recordings_support import FOLDER_VARIABLE

from blind.bench_rows import bench_rows
from blind.folder import SetFolder
from blind.prepare import OtherSetError, prepare
from blind.rows.table import ROWS, find_case, impossible_rows
from blind.run import Options, run_set
from blind.score import score
from blind.table import as_json, markdown, terminal_text
from blind.tried import open_all

SEED = 4711
"""Of a set where no other one is asked for."""


def main(argv: list[str] | None = None) -> int:
    """One of the commands; 0 done, 1 a seal is broken or a folder is another set's, 130 interrupted."""
    arguments = _parser().parse_args(argv)
    try:
        arguments.act(arguments)
    except (BrokenSealError, OtherSetError) as error:
        print(f"blind: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("blind: interrupted; the same command goes on from here", file=sys.stderr)
        return 130
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m benchmark blind", description=__doc__)
    commands = parser.add_subparsers(required=True)
    run = commands.add_parser("run", help="seal a set, then run what has no result yet")
    _add_seed(run)
    run.add_argument("--out", type=Path, required=True, help="folder of the set")
    run.add_argument("--workers", type=int, default=2, help="cases at a time (2)")
    run.add_argument("--timeout", type=float, default=600.0, help="seconds after which a run has failed (600)")
    run.add_argument("--no-oracle", action="store_true", help="leave out the runs that may fit the true effect only")
    run.add_argument("--keep", action="store_true", help="keep the sessions under kept/")
    run.add_argument("--only", action="append", default=[], help="part of a title, as single/3/latency")
    run.add_argument("--rows", type=_rows, default=[], help=f"by comma: {', '.join(ROWS)} (all)")
    run.add_argument("--count", type=int, help="cases of each row (what each row has)")
    run.set_defaults(act=_run)
    scored = commands.add_parser("score", help="open the seals and judge")
    scored.add_argument("out", type=Path, help="folder of the set")
    scored.set_defaults(act=_score)
    show = commands.add_parser("show", help="open one seal")
    show.add_argument("case")
    show.add_argument("--out", type=Path, required=True, help="folder of the set")
    show.set_defaults(act=_show)
    generate = commands.add_parser("generate", help="write the sessions and the rig of one case")
    _add_seed(generate)
    generate.add_argument("--case", required=True, help="its name, or row and number: none_own/12")
    generate.add_argument("--out", type=Path, required=True, help="folder that is made")
    generate.set_defaults(act=_generate)
    return parser


def _add_seed(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--seed", type=int, default=SEED, help=f"of the cases ({SEED})")


def _rows(text: str) -> list[str]:
    rows = text.split(",")
    for row in rows:
        if row not in ROWS:
            raise argparse.ArgumentTypeError(f"there is no row {row}; there are {', '.join(ROWS)}")
    return rows


def _run(arguments: argparse.Namespace) -> None:
    if impossible := impossible_rows(arguments.rows):
        print(
            f"blind: {', '.join(impossible)}: left out, no folder of recordings: set {FOLDER_VARIABLE}", file=sys.stderr
        )
    folder = SetFolder(arguments.out)
    prepare(folder, arguments.seed, arguments.rows, arguments.count, arguments.only)
    options = Options(
        workers=arguments.workers,
        timeout_s=arguments.timeout,
        oracle=not arguments.no_oracle,
        keep=arguments.keep,
    )
    run_set(folder, options, lambda text: print(text, file=sys.stderr, flush=True))


def _score(arguments: argparse.Namespace) -> None:
    folder = SetFolder(arguments.out)
    found = score(open_all(folder), bench_rows)
    write_json(folder.root / "score.json", as_json(found))
    (folder.root / "table.md").write_text(markdown(found))
    print(terminal_text(found), end="")


def _show(arguments: argparse.Namespace) -> None:
    print(json.dumps(SetFolder(arguments.out).open_seal(arguments.case, "show"), indent=1, ensure_ascii=False))


def _generate(arguments: argparse.Namespace) -> None:
    case = find_case(arguments.seed, arguments.case)
    if case is None:
        raise OtherSetError(f"{arguments.case}: is no case of seed {arguments.seed}")
    case.write(arguments.out)
