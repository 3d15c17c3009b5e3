"""The blind check stands apart: what it imports, and what a case is generated from."""

import ast
from pathlib import Path

import pytest

FOLDER = Path(__file__).parent
MODULES = sorted(path for path in FOLDER.rglob("*.py") if not path.name.startswith("test_"))


def imports_of(path: Path) -> set[str]:
    found = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            found |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: imports are absolute"
            found.add((node.module or "").split(".")[0])
    return found


@pytest.mark.parametrize("path", MODULES, ids=lambda path: str(path.relative_to(FOLDER)))
def test_nothing_of_the_program_is_imported(path: Path) -> None:
    """Neither the simulator that explains nor the program that is judged, by no way of importing."""
    assert not imports_of(path) & {"gyrodrift", "firmware_sim", "importlib", "runpy"}
    assert "__import__" not in path.read_text()


@pytest.mark.parametrize("path", sorted((FOLDER / "generator").glob("*.py")), ids=lambda path: path.stem)
def test_the_generator_needs_numpy_and_scipy_alone(path: Path) -> None:
    """And the standard library, and nothing of what runs and scores but the names of the effects."""
    allowed = {"blind", "numpy", "scipy", "collections", "dataclasses", "enum", "hashlib", "math", "pathlib", "typing"}
    assert imports_of(path) <= allowed
    inner = {
        node.module
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("blind")
    }
    assert all(module == "blind.catalogue" or str(module).startswith("blind.generator") for module in inner)
