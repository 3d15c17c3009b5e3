"""Constants of the attitude filter in `gyrodrift.h` against those of Python, by name and value."""

import ast
import ctypes
import importlib
import pkgutil
import re
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from c_filter_support import words, write_header
from firmware_support import run

from gyrodrift.filters import attitude
from gyrodrift.filters.attitude.rests import KINDS
from gyrodrift.filters.attitude.witness import STILL
from gyrodrift.filters.beliefs import MAX_HYPOTHESES, PARTS
from gyrodrift.firmware.parameters import FILTERS_FOLDER

ABSENT = {
    "IDENTITY": "gd_identity",
    "KINDS": "gd_attitude_kind_of",
    "QUIET": "gd_attitude_kind_of",
    "BRIEF": "gd_attitude_kind_of",
    "NOISY": "gd_attitude_kind_of",
    "LONG_NOISY": "gd_attitude_kind_of",
    "STILL": "gd_attitude_still",
    "AIDED": "functions",
    "LEAST_VAR": "the source has no errors of its own",
    "UNITS": "of two spreads",
    "VERTICAL": "a unit vector",
}
"""Python constants that C writes in another way."""

OWN = {
    "HYPOTHESES": "MAX_HYPOTHESES",
    "SLOTS": "each hypothesis may branch",
    "PIVOT": "inverse of a matrix",
    "LOG_LEAST": "of 1e-300",
    "LOG_TURN": "of 2 pi",
    "LONGEST_GAP_S": "a float ends at 1e38",
    "LARGEST_FLOAT_BIAS": "digits of a float",
    "PIVOT_SHARE": "inverse of a matrix",
    "QUIET_BLOCKS": "KINDS",
    "BRIEF_BLOCKS": "KINDS",
    "ROW": "a row of a covariance",
    "QUEUE": "samples that wait for portions of work",
    "SAMPLES_PER_PORTION": "samples that wait for portions of work",
}
"""Constants that only C has, with what they are of."""

DEFINED = re.compile(r"^#define GD_ATTITUDE_(\w+) \S", re.MULTILINE)
ENUM = re.compile(r"^enum \{(.*?)\};", re.MULTILINE | re.DOTALL)


def names_in_c() -> list[str]:
    """Names of macros and enumerators without GD_ATTITUDE_."""
    text = "".join(part.read_text() for part in sorted(FILTERS_FOLDER.glob("attitude*.h")))
    enumerators = [re.findall(r"GD_ATTITUDE_(\w+) = ", body) for body in ENUM.findall(text)]
    return [*DEFINED.findall(text), *(name for names in enumerators for name in names)]


def in_python() -> dict[str, object]:
    """Constants of all modules of the filter and of quaternions, but for those in ABSENT."""
    constants: dict[str, object] = {}
    names = [info.name for info in pkgutil.iter_modules(attitude.__path__, f"{attitude.__name__}.")]
    for module in map(importlib.import_module, [*names, "gyrodrift.values.quaternion"]):
        for name in assigned(Path(str(module.__file__))):
            if name not in ABSENT:
                value = getattr(module, name)
                assert constants.setdefault(name, value) == value, name
    return constants


def assigned(path: Path) -> Iterator[str]:
    """Names in capitals that a module assigns."""
    for node in ast.parse(path.read_text()).body:
        targets = node.targets if isinstance(node, ast.Assign) else []
        for name in (part for target in targets for part in ast.walk(target)):
            if isinstance(name, ast.Name) and name.id.isupper():
                yield name.id


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    """All constants of C as doubles, and its kinds of rest."""
    if shutil.which("cc") is None:
        pytest.skip("there is no C compiler: apt-get install gcc")
    folder = tmp_path_factory.mktemp("constants")
    write_header(folder)
    lines = [f"double value_{name}(void);\ndouble value_{name}(void) {{ return (double)GD_ATTITUDE_{name}; }}"
             for name in names_in_c()]  # fmt: skip
    kinds = (
        "void kind(int i, double *out);\nvoid kind(int i, double *out) {\n"
        "  const gd_attitude_kind k = i < 4 ? gd_attitude_kind_of(i) : gd_attitude_still();\n"
        "  out[0] = k.blocks; out[1] = k.gyro; out[2] = k.accel; out[3] = k.bias;\n}\n"
    )
    (folder / "constants.c").write_text("\n".join(['#include "gyrodrift.h"', *lines, kinds]))
    flags = words("use_filters.c", "double")[:-1]
    run("cc", "-std=c11", *flags, "-shared", "-fPIC", "constants.c", "-o", "constants.so", "-lm", folder=folder)
    return ctypes.CDLL(str(folder / "constants.so"))


def value_of(library: ctypes.CDLL, name: str) -> float:
    function = library[f"value_{name}"]
    function.restype = ctypes.c_double
    return float(function())


def test_each_python_constant_has_its_value_in_c(library: ctypes.CDLL) -> None:
    """A change in Python fails here until C follows; three states are named by the first of them."""
    constants = in_python()
    assert len(constants) > 80
    for name, value in constants.items():
        number = value.start if isinstance(value, slice) else value
        assert isinstance(number, int | float), name
        assert value_of(library, name) == pytest.approx(number, rel=1e-15), name


def test_each_c_constant_is_one_of_python() -> None:
    """A constant that only C has needs an entry in OWN."""
    assert set(names_in_c()) - set(in_python()) == set(OWN)


def test_the_kinds_of_rest_are_those_of_python(library: ctypes.CDLL) -> None:
    for index, kind in enumerate((*KINDS, STILL)):
        numbers = (ctypes.c_double * 4)()
        library.kind(index, numbers)
        assert tuple(numbers) == tuple(kind)


def test_the_kinds_of_parts_are_those_of_python() -> None:
    """Both filters have them; the first two kinds have one share."""
    text = (FILTERS_FOLDER / "beliefs.h").read_text().partition("/* Share of a kind. */")[2].partition("/* Odds")[0]
    numbers = [float(number) for number in re.findall(r"GD_R\(([\d.]+)\)", text)]
    shares, widths = zip(*PARTS, strict=True)
    assert shares[0] == shares[1]
    assert numbers == [*shares[1:], *widths]


def test_as_many_hypotheses_are_kept_as_in_python(library: ctypes.CDLL) -> None:
    """Six, unless a macro says another number."""
    assert value_of(library, "HYPOTHESES") == MAX_HYPOTHESES
