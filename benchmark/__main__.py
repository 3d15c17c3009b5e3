"""Run a program of this folder: `python -m benchmark NAME ...`; README.md lists the programs.

Programs, and the helpers that they share with the tests, are modules as in pytest: `evaluate`, `support`.
"""

import runpy
import sys
from pathlib import Path

FOLDER = Path(__file__).resolve().parent


def main() -> None:
    """Run the module that the first argument names, with the arguments behind it."""
    if len(sys.argv) == 1 or not (FOLDER / sys.argv[1].partition(".")[0]).is_dir():
        raise SystemExit("usage: python -m benchmark NAME ...; benchmark/README.md lists the programs")
    del sys.argv[0]
    sys.path[:0] = [str(FOLDER), str(FOLDER.parent / "tests")]
    runpy.run_module(sys.argv[0], run_name="__main__", alter_sys=True)


if __name__ == "__main__":
    main()
