"""The promises of docs/promises.csv, read from the tests that hold them: `python tests/promises.py` writes the list.

A test holds a promise if it has the mark `promise(AREA)`. The promise is the first line of its docstring, or the second
argument of the mark.
"""

import ast
import csv
from collections.abc import Iterator
from io import StringIO
from pathlib import Path

ROOT = Path(__file__).parent.parent
LIST = ROOT / "docs" / "promises.csv"
FOLDERS = ("tests", "benchmark")


def marks_in(path: Path) -> Iterator[tuple[str, str, str]]:
    """Area, promise and test of each mark in a file."""
    functions = (node for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.FunctionDef))
    for node in functions:
        for mark in node.decorator_list:
            if isinstance(mark, ast.Call) and ast.unparse(mark).startswith("pytest.mark.promise("):
                area, *text = [ast.literal_eval(argument) for argument in mark.args]
                statement = text or [(ast.get_docstring(node) or "").partition("\n")[0].rstrip(".")]
                yield area, statement[0], f"{path.relative_to(ROOT)}::{node.name}"


def listed() -> str:
    """The list as csv: area, promise and the tests that hold it, by area and promise."""
    tests: dict[tuple[str, str], list[str]] = {}
    for folder in FOLDERS:
        for path in sorted((ROOT / folder).rglob("test_*.py")):
            for area, promise, test in marks_in(path):
                tests.setdefault((area, promise), []).append(test)
    text = StringIO()
    rows = ((area, promise, " ".join(names)) for (area, promise), names in sorted(tests.items()))
    csv.writer(text, lineterminator="\n").writerows([("area", "promise", "tests"), *rows])
    return text.getvalue()


if __name__ == "__main__":
    LIST.write_text(listed())
