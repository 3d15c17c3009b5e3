"""Every test asserts something where a reader sees it: in its own body, or by a helper whose name says so."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

TESTS = Path(__file__).parent

EXPECTATIONS = {"raises", "warns", "fail"}
"""Names of pytest."""


def functions_of(path: Path) -> Iterator[ast.FunctionDef]:
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.FunctionDef) and node.name.startswith("test"):
            yield node


def has_assert(function: ast.AST) -> bool:
    """Whether a test function asserts, expects an exception or a warning, or calls a helper named `assert_…`."""
    return any(isinstance(node, ast.Assert) or _is_expectation(node) for node in ast.walk(function))


def _is_expectation(node: ast.AST) -> bool:
    if not isinstance(node, ast.Call):
        return False
    name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
    return name in EXPECTATIONS or name.startswith("assert_")


def test_every_test_shows_what_it_asserts() -> None:
    paths = sorted(TESTS.rglob("test_*.py"))
    silent = [
        f"{path.relative_to(TESTS)}::{item.name}"
        for path in paths
        for item in functions_of(path)
        if not has_assert(item)
    ]
    assert silent == []


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ("check(1)", False),
        ("assert one", True),
        ("with pytest.raises(ValueError): f()", True),
        ("for one in some:\n  np.testing.assert_allclose(one, 1.0)", True),
        ("assert_holds(1)", True),
    ],
)
def test_a_silent_test_is_found(body: str, *, expected: bool) -> None:
    assert has_assert(ast.parse(body)) == expected
