"""The blind check stands apart: what it imports, and what a case is generated from."""

import ast
from pathlib import Path

import pytest

BENCHMARK = Path(__file__).parents[2] / "benchmark"
FOLDER, PHYSICS = BENCHMARK / "blind", BENCHMARK / "gyrogap" / "physics"
MODULES = sorted(FOLDER.rglob("*.py"))


def modules_of(path: Path) -> set[str]:
    result = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            result |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: imports are absolute"
            result.add(node.module or "")
    return result


@pytest.mark.parametrize("path", MODULES, ids=lambda path: str(path.relative_to(FOLDER)))
def test_nothing_of_the_program_is_imported(path: Path) -> None:
    modules = {module for module in modules_of(path) if not module.startswith("gyrogap")}
    assert not {module.split(".")[0] for module in modules} & {"gyrodrift", "firmware_sim", "importlib", "runpy"}
    assert "__import__" not in path.read_text()


@pytest.mark.parametrize("path", sorted(PHYSICS.glob("*.py")), ids=lambda path: path.stem)
def test_the_generator_needs_numpy_and_scipy_alone(path: Path) -> None:
    standard = {"collections", "dataclasses", "enum", "hashlib", "itertools", "math", "pathlib", "typing"}
    own = {module for module in modules_of(path) if module.startswith("gyrogap")}
    assert {module.split(".")[0] for module in modules_of(path) - own} <= standard | {"numpy", "scipy"}
    inner = ("gyrogap.catalogue", "gyrogap.physics")
    assert all(module.startswith(inner) for module in own)
