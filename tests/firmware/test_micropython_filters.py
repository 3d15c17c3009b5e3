"""HDR and restlevel in MicroPython: equal to Python in doubles, and close in floats of 32 bits."""

import ast
import importlib.util
import json
import math
import sys
import types
from collections.abc import Callable
from dataclasses import astuple
from math import nan
from pathlib import Path
from typing import Any, Self

import numpy as np
import pytest
from firmware_support import MICROPYTHON, in_micropython

from gyrodrift.filters import limits
from gyrodrift.filters.hdr import HdrParams
from gyrodrift.filters.registry import FILTERS
from gyrodrift.firmware.micropython import FILES, restlevel_py
from gyrodrift.firmware.my_gyro import TunedGyro

Samples = list[list[float | None]]
DRIVE_S = 60.0
NO_TIE = {"window_s": 0.295}
"""Blocks that end between two samples of 100 Hz: at 0.3 s a rounded clock decides whether a sample more belongs."""

PARAMS: dict[str, dict[str, float]] = {"hdr": {}, "restlevel": NO_TIE}


def rates_dps(seconds: float, hz: float = 100.0, seed: int = 1) -> tuple[list[float], list[float], list[float]]:
    """Times, rates and temperatures of a drive with rests: a bias that follows the temperature, noise, and turns."""
    random = np.random.default_rng(seed)
    t_s = np.arange(0.0, seconds, 1.0 / hz)
    phase = t_s % 40.0
    turning = np.where((phase > 15.0) & (phase < 35.0), 40.0 * np.sin(0.7 * t_s), 0.0)
    temp_c = 25.0 + 0.02 * t_s
    measured = turning + 0.4 + 0.005 * (temp_c - 25.0) + 0.05 * random.standard_normal(len(t_s))
    return t_s.tolist(), (np.round(measured * 131) / 131).tolist(), temp_c.tolist()


def run_there(
    folder: Path, name: str, samples: Samples, params: dict[str, float] | None = None, *, is_us: bool = False
) -> Any:
    """Rows and memory of a filter in MicroPython."""
    (folder / "gyrodrift_restlevel.py").write_text(restlevel_py())
    request = {"filter": name, "params": params or {}, "clock": "us" if is_us else "s", "samples": samples}
    return json.loads(in_micropython("run_filter.py", request, folder, folder / "gyrodrift_restlevel.py"))


def run_here(name: str, samples: Samples, **params: float) -> list[list[float]]:
    """Whether a sample is taken, yaw, its sigma and bias after each, by Python."""
    kind = FILTERS[name]
    coefficients, state = kind.coefficients(kind.params(**params)), kind.state()
    rows = []
    for sample in samples:
        values = [nan if value is None else value for value in (*sample, None, None)[:4]]
        taken = kind.step_auxiliary(coefficients, state, *values)
        rows.append([taken, state.yaw_deg, state.yaw_sigma_deg, state.bias_dps])
    return rows


@pytest.mark.parametrize("params", [{}, {"i_c_dps": 0.01, "tau_s": 0.0, "theta_w_dps": 5.0, "c1": 0.0}])
def test_hdr_has_the_yaw_of_python(tmp_path: Path, params: dict[str, float]) -> None:
    t_s, rates, _ = rates_dps(DRIVE_S)
    samples: Samples = [[t, rate] for t, rate in zip(t_s, rates, strict=True)]
    samples[50:50] = [[0.3, 1.0], [0.5, None], [1e16, 0.0], [0.495, 2e12]]
    rows = run_there(tmp_path, "hdr", samples, params)["rows"]
    expected = run_here("hdr", samples, **params)
    assert [row[0] for row in rows] == [row[0] for row in expected]
    assert sum(row[0] for row in rows) == len(rows) - 4
    np.testing.assert_allclose(columns(rows, 1, 3), columns(expected, 1, 3), rtol=0, atol=1e-9)


@pytest.mark.parametrize("has_more", [False, True], ids=["rate", "rest and temperature"])
def test_restlevel_has_the_yaw_of_python(tmp_path: Path, has_more: bool) -> None:  # noqa: FBT001 - a parameter
    """Yaw, sigma and bias to 1e-9 after each sample; also with a rest sensor and a thermometer."""
    t_s, rates, temps = rates_dps(DRIVE_S)
    still = [float(t % 40.0 < 14.5) for t in t_s]
    samples: Samples = [
        [t, rate, rest, temp] if has_more else [t, rate]
        for t, rate, rest, temp in zip(t_s, rates, still, temps, strict=True)
    ]
    samples[70:70] = [[0.3, 1.0], [0.69, None]]
    rows = run_there(tmp_path, "restlevel", samples, {"window_s": 0.25})["rows"]
    expected = run_here("restlevel", samples, window_s=0.25)
    assert [row[0] for row in rows] == [row[0] for row in expected]
    np.testing.assert_allclose(columns(rows, 1, 2, 3), columns(expected, 1, 2, 3), rtol=0, atol=1e-9)


def columns(rows: list[list[float]], *indices: int) -> "np.ndarray[tuple[int, ...], np.dtype[np.float64]]":
    return np.array([[row[index] for index in indices] for row in rows])


@pytest.mark.parametrize("name", ["hdr", "restlevel"])
def test_the_clock_of_a_board_may_wrap(tmp_path: Path, name: str) -> None:
    """`time.ticks_us` of most ports has 30 bits, which end after 18 minutes."""
    t_s, rates, _ = rates_dps(30.0)
    ticks = [(round(t * 1e6) + (1 << 30) - 7_000_000) % (1 << 30) for t in t_s]
    samples: Samples = [[t, rate] for t, rate in zip(ticks, rates, strict=True)]
    rows = run_there(tmp_path, name, samples, PARAMS[name], is_us=True)["rows"]
    here: Samples = [[round(t, 6), rate] for t, rate in zip(t_s, rates, strict=True)]
    expected = run_here(name, here, **PARAMS[name])
    assert all(row[0] for row in rows)
    np.testing.assert_allclose(columns(rows, 1, 3), columns(expected, 1, 3), rtol=0, atol=1e-8)


def test_a_tick_that_repeats_is_refused(tmp_path: Path) -> None:
    """Time has to advance; half of the range counts as back."""
    for name in ("hdr", "restlevel"):
        samples: Samples = [[1000, 1.0], [1000, 1.0], [900, 1.0], [2000, 1.0], [3000, None]]
        rows = run_there(tmp_path, name, samples, is_us=True)["rows"]
        assert [row[0] for row in rows] == [True, False, False, True, False]


def test_memory_of_both_filters(tmp_path: Path) -> None:
    samples: Samples = [[0.01 * index, 0.5] for index in range(200)]
    hdr, restlevel = (run_there(tmp_path, name, samples) for name in ("hdr", "restlevel"))
    print({name: hdr[name] for name in ("module", "state", "sample")})
    print({name: restlevel[name] for name in ("module", "state", "sample")})
    assert hdr["module"] < 5_000
    assert hdr["state"] < 500
    assert restlevel["module"] < 62_000
    assert restlevel["state"] < 10_000
    assert hdr["sample"] < 700
    assert restlevel["sample"] < 1300


class Float32(float):
    """A float of 32 bits, as many ports have: each result is rounded to it."""

    def __new__(cls, value: float) -> Self:
        return super().__new__(cls, np.float32(value))


def _rounded(name: str) -> Callable[..., Any]:
    of_float = getattr(float, name)

    def method(*values: float) -> Any:
        result = of_float(*values)
        return Float32(result) if type(result) is float else result

    return method


for _name in ["add", "sub", "mul", "truediv", "pow", "radd", "rsub", "rmul", "rtruediv", "rpow", "neg", "abs"]:
    setattr(Float32, f"__{_name}__", _rounded(f"__{_name}__"))


def module_in_float32(source: str) -> types.ModuleType:
    """A module whose numbers with a point, and results of mathematics, are floats of 32 bits."""

    class Narrow(ast.NodeTransformer):
        def visit_Constant(self, node: ast.Constant) -> ast.AST:
            if not isinstance(node.value, float):
                return node
            return ast.copy_location(ast.Call(ast.Name("Float32", ast.Load()), [node], []), node)

    def narrow(function: Callable[..., float]) -> Callable[..., Float32]:
        return lambda *values: Float32(function(*values))

    module = types.ModuleType("narrow")
    tree = ast.fix_missing_locations(Narrow().visit(ast.parse(source)))
    is_import = [isinstance(node, ast.ImportFrom) and node.module in ("math", "time") for node in tree.body]
    tree.body = [node for node, is_one in zip(tree.body, is_import, strict=True) if not is_one]
    functions = {name: narrow(getattr(math, name)) for name in ("exp", "log", "sqrt")}
    module.__dict__.update(Float32=Float32, floor=math.floor, ticks_diff=lambda end, start: end - start, **functions)
    exec(compile(tree, "narrow", "exec"), module.__dict__)
    return module


@pytest.mark.parametrize(("name", "most_deg"), [("hdr", 0.01), ("restlevel", 0.01)])
def test_floats_of_32_bits_keep_the_yaw(name: str, most_deg: float) -> None:
    source = (MICROPYTHON / "gyrodrift_hdr.py").read_text() if name == "hdr" else restlevel_py()
    module = module_in_float32(source)
    given = {key: Float32(value) for key, value in PARAMS[name].items()}
    narrow = module.Hdr(**given) if name == "hdr" else module.Restlevel(**given)
    kind = FILTERS[name]
    coefficients, state = kind.coefficients(kind.params(**PARAMS[name])), kind.state()
    t_s, rates, _ = rates_dps(100.0)
    apart = 0.0
    for t, rate in zip(t_s, rates, strict=True):
        narrow.update_us(round(t * 1e6), Float32(rate))
        kind.step(coefficients, state, round(t, 6), rate)
        apart = max(apart, abs(narrow.yaw_deg - state.yaw_deg))
    print(f"{name}: {apart:.2g} deg apart; {state.yaw_deg:.1f} deg")
    assert type(narrow.yaw_deg) is Float32
    assert apart <= most_deg


def test_hdr_has_the_parameters_and_limits_of_python(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("time.ticks_diff", lambda end, start: end - start, raising=False)
    spec = importlib.util.spec_from_file_location("gyrodrift_hdr", MICROPYTHON / "gyrodrift_hdr.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    assert module.Hdr.__init__.__defaults__ == astuple(HdrParams())
    assert (module.MOST_S, module.MOST_DPS, module.LEAST_STEP_S) == (
        limits.MOST_S, limits.MOST_DPS, limits.LEAST_STEP_S
    )  # fmt: skip


def test_restlevel_is_the_source_of_python() -> None:
    package = Path(sys.modules["gyrodrift.filters.restlevel.model"].__file__ or "").parent
    files = {f"restlevel.{path.stem}" for path in package.glob("*.py")}
    assert files - set(FILES) == {"restlevel.__init__", "restlevel.memory", "restlevel.aided"}
    assert "import gyrodrift" not in restlevel_py()
    assert TunedGyro.__module__ not in restlevel_py()
