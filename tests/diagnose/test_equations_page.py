"""The worked example and the table of constants in docs/diagnosis-equations.md."""

import doctest
import re
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType

import pytest

PAGE = Path(__file__).parents[2] / "docs" / "diagnosis-equations.md"
ROW = re.compile(r"^\| `(\w+)\.([A-Z_]+)` \| ([^|]+) \| [^|]+ \| ([^|]+) \|$", re.MULTILINE)
ROWS = ROW.findall(PAGE.read_text(encoding="utf-8"))


def module_of(name: str) -> ModuleType:
    names = (f"gyrodrift.diagnose.{package}.{name}" for package in ("inference", "simulate"))
    return import_module(next(full for full in names if find_spec(full)))


def test_the_page_lists_the_constants_of_the_density() -> None:
    names = {name for module, name, *_ in ROWS if module == "density"}
    assert {name for name in vars(module_of("density")) if name.isupper()} == names


@pytest.mark.promise("Analyses and reports")
@pytest.mark.parametrize(("module", "name", "values", "source"), ROWS, ids=[".".join(row[:2]) for row in ROWS])
def test_a_constant_has_its_value_and_a_source(module: str, name: str, values: str, source: str) -> None:
    """Each constant in the equations of diagnosis has the value of the code."""
    value = getattr(module_of(module), name)
    value = tuple(value.values()) if isinstance(value, dict) else value
    stated = [float(number) for number in values.split(", ")]
    assert stated == pytest.approx(list(value) if isinstance(value, tuple) else [value])
    assert source.strip()


def test_the_worked_example_gives_its_numbers() -> None:
    failures, examples = doctest.testfile(str(PAGE), module_relative=False)
    assert (failures, examples) == (0, 12)
