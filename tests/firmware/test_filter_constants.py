"""Constants of `gyrodrift.h` against those of the Python filters, by name and value."""

import ast
import importlib
import pkgutil
import re
from math import log, pi
from pathlib import Path

from gyrodrift.filters import beliefs, contradictions, limits, restlevel
from gyrodrift.filters.restlevel import memory
from gyrodrift.firmware.parameters import FILTERS_FOLDER

ABSENT = {
    "MAX_REMEMBERED": "the bias alone is remembered",
    "SAME_PERIOD": "the bias alone is remembered",
    "RECALLED_BLOCKS": "the bias alone is remembered",
    "LOOP_VAR_C": "the bias alone is remembered",
    "SIMILAR_START_C": "the bias alone is remembered",
    "STARTS_KEPT": "the bias alone is remembered",
    "FACTOR_STARTS": "the bias alone is remembered",
    "FACTOR_CLIP": "the bias alone is remembered",
    "LEAST_FACTOR": "the bias alone is remembered",
    "MOST_FACTOR": "the bias alone is remembered",
    "AGREEMENT_ODDS": "its logarithm is used",
    "NEVER": "the count stays at 255",
    "MAX_HYPOTHESES": "GD_RESTLEVEL_HYPOTHESES",
    "MAX_LOG_ODDS": "a float overflows sooner",
}
"""Python constants that C has not or has with other values, with the reason."""

OWN = {
    "GD_PI",
    "GD_RESTLEVEL_HYPOTHESES",
    "GD_RESTLEVEL_WORK",
    "GD_PARTS",
    "GD_RL_DEFAULT_PARTS",
    "GD_FAR_S",
    "GD_NEVER",
    "GD_LOG_USUAL_NOISE",
    "GD_RL_BASE_DEG",
    "GD_LEAST_REMEMBERED_VAR",
    "GD_MOST_REMEMBERED_DPS",
    "GD_MOST_REMEMBERED_SIGMA",
}
"""Constants that only C has."""

OF_RESTLEVEL = ("re*.h", "beliefs.h", "bias_*.h", "contradictions.h")
"""Parts with constants of restlevel and of what both filters share."""

NUMBER = re.compile(r"#define (GD_[A-Z0-9_]+) +(?:GD_R\()?(-?[0-9][0-9.e+-]*)\)?(?:\s|$)")


def in_c() -> dict[str, float]:
    """Numeric constants of restlevel and of what both filters share."""
    parts = [part for pattern in OF_RESTLEVEL for part in sorted(FILTERS_FOLDER.glob(pattern))]
    lines = [line for part in parts for line in part.read_text().splitlines()]
    return {match[1]: float(match[2]) for line in lines if (match := NUMBER.match(line.strip()))}


def in_python() -> dict[str, float]:
    """Numeric constants of restlevel and the limits."""
    names = [f"{restlevel.__name__}.{module.name}" for module in pkgutil.iter_modules(restlevel.__path__)]
    modules = [importlib.import_module(name) for name in names]
    constants: dict[str, float] = {}
    for module in (limits, beliefs, contradictions, *modules):
        for name in assigned(Path(str(module.__file__))):
            value = getattr(module, name)
            if isinstance(value, int | float) and (module, name) != (memory, "LEAST_VAR"):
                assert constants.setdefault(name, value) == value, name
    return constants


def assigned(path: Path) -> list[str]:
    """Names in capitals that a module assigns."""
    targets = [node.targets for node in ast.parse(path.read_text()).body if isinstance(node, ast.Assign)]
    nodes = [node for target in targets for item in target for node in ast.walk(item)]
    return [node.id for node in nodes if isinstance(node, ast.Name) and node.id.isupper()]


def test_each_python_constant_has_its_value_in_c() -> None:
    """A change in Python fails here until C follows."""
    ours, theirs = in_python(), in_c()
    assert len(ours) > 90
    for name in set(ours) - set(ABSENT):
        if name in ("UNKNOWN_C", "UNSAID_C"):
            continue
        assert theirs[f"GD_{name}"] == ours[name], name


def test_each_c_constant_is_one_of_python() -> None:
    """A constant that only C has needs an entry in OWN."""
    ours = in_python()
    assert {name for name in in_c() if name.removeprefix("GD_") not in ours} <= OWN


def test_constants_with_a_name_in_c_are_equal() -> None:
    """An unknown temperature has two names."""
    text = "".join(part.read_text() for part in FILTERS_FOLDER.glob("bias_*.h"))
    assert "#define GD_UNKNOWN_C GD_UNSAID_C" in text
    assert in_c()["GD_UNSAID_C"] == in_python()["UNKNOWN_C"]


def test_constants_of_c_alone_follow_from_those_of_python() -> None:
    """Number of hypotheses, and a logarithm that is worked out beforehand."""
    ours = in_python()
    text = (FILTERS_FOLDER / "restlevel_model.h").read_text()
    assert f"#else\n#define GD_RESTLEVEL_HYPOTHESES {int(ours['MAX_HYPOTHESES'])}\n" in text
    assert in_c()["GD_LOG_USUAL_NOISE"] == log(ours["USUAL_NOISE_DPS"])
    assert in_c()["GD_LEAST_REMEMBERED_VAR"] == memory.LEAST_VAR
    assert in_c()["GD_PI"] == pi
