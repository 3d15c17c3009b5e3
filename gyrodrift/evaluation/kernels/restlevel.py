"""Restlevel for many parameter vectors, compiled from its source, bit for bit the same."""

from collections.abc import Callable
from dataclasses import fields, is_dataclass
from functools import cache
from math import erf, exp, pi, sqrt
from types import FunctionType
from typing import Any, get_args, get_origin, get_type_hints

import numpy as np
from numba import njit

from gyrodrift.evaluation.auxiliary import NO_AUXILIARY, Auxiliary
from gyrodrift.evaluation.kernels.kernel import SUMS, Kernel, infinite_where_yaw_overflows
from gyrodrift.filters.restlevel.model import RestlevelParams, RestlevelState
from gyrodrift.filters.restlevel.step import advance, coefficients
from gyrodrift.io.compile import compiled_once, stamp_of
from gyrodrift.values.arrays import Floats

KINDS: dict[Any, str] = {float: "f8", int: "i8", bool: "?"}


def compiled(function: FunctionType) -> Callable[..., Any]:
    """Compile a function and the functions of the same package that it calls."""
    made: Callable[..., Any] = njit(nogil=True, error_model="numpy")(_with_compiled_callees(function))
    return made


@cache
def compiled_callee(function: FunctionType) -> Callable[..., Any]:
    """Compile a function for compiled callers only: without a Python wrapper this takes a quarter less time."""
    options: dict[str, Any] = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
    made: Callable[..., Any] = njit(nogil=True, error_model="numpy", **options)(_with_compiled_callees(function))
    return made


def _with_compiled_callees(function: FunctionType) -> FunctionType:
    package = function.__module__.split(".")[0]
    names = dict(function.__globals__)
    for name in function.__code__.co_names:
        called = names.get(name)
        if isinstance(called, FunctionType) and called.__module__.split(".")[0] == package:
            names[name] = compiled_callee(called)
    return FunctionType(function.__code__, names, function.__name__, function.__defaults__, function.__closure__)


@cache
def layout(record: type) -> np.dtype[Any]:
    """Structured type with the fields of a dataclass.

    A field is a float, an int, a bool, a dataclass, or a list of dataclasses as long as in a new record.
    """
    slots: list[tuple[Any, ...]] = []
    hints = get_type_hints(record)
    for slot in fields(record):
        kind = hints[slot.name]
        if kind in KINDS:
            slots.append((slot.name, KINDS[kind]))
        elif get_origin(kind) is list:
            (inner,) = get_args(kind)
            slots.append((slot.name, layout(inner), (len(getattr(record(), slot.name)),)))
        else:
            slots.append((slot.name, layout(kind)))
    return np.dtype(slots, align=True)


def array_of(value: Any) -> np.ndarray[tuple[int], np.dtype[Any]]:
    """Structured array with one record."""
    record: Any = type(value)
    made = np.zeros(1, layout(record))
    _fill(made[0], value)
    return made


def _fill(slot: Any, value: Any) -> None:
    for entry in fields(value):
        content = getattr(value, entry.name)
        if isinstance(content, list):
            for inner, part in zip(slot[entry.name], content, strict=True):
                _fill(inner, part)
        elif is_dataclass(content):
            _fill(slot[entry.name], content)
        else:
            slot[entry.name] = content


_advance: Any = compiled_callee(advance)
_NEW_STATE = array_of(RestlevelState())


def sums(
    dt_s: Floats, rate_dps: Floats, reference_deg: Floats, params: Floats, auxiliary: Auxiliary = NO_AUXILIARY
) -> Floats:
    """Sums over the samples with a reference, as `Kernel.sums` gives them; `params` as in RestlevelParams."""
    result, walked = np.empty((SUMS, len(params))), np.empty((3, len(dt_s)))
    for column, row in enumerate(params.tolist()):
        _follow(_coefficients(row), _NEW_STATE.copy(), dt_s, rate_dps, *auxiliary, walked)
        _add_up(walked, reference_deg, result[:, column])
    return infinite_where_yaw_overflows(result)


def walk(dt_s: Floats, rate_dps: Floats, params: RestlevelParams, auxiliary: Auxiliary = NO_AUXILIARY) -> Floats:
    """Yaw in deg, its standard deviation in deg and the bias in deg/s, shape (3, n)."""
    walked = np.empty((3, len(dt_s)))
    _follow(array_of(coefficients(params)), _NEW_STATE.copy(), dt_s, rate_dps, *auxiliary, walked)
    return walked


def yaw(dt_s: Floats, rate_dps: Floats, params: Floats, auxiliary: Auxiliary = NO_AUXILIARY) -> Floats:
    """Yaw of one parameter vector, deg, shape (n,)."""
    yaw_deg: Floats = walk(dt_s, rate_dps, RestlevelParams(*params.tolist()), auxiliary)[0]
    return yaw_deg


def sigma(dt_s: Floats, rate_dps: Floats, params: Floats, auxiliary: Auxiliary = NO_AUXILIARY) -> Floats:
    """Standard deviation of the yaw of one parameter vector, deg, shape (n,)."""
    sigma_deg: Floats = walk(dt_s, rate_dps, RestlevelParams(*params.tolist()), auxiliary)[1]
    return sigma_deg


def _coefficients(row: list[float]) -> Any:
    return array_of(coefficients(RestlevelParams(*row)))


def _compiled() -> Any:
    """Compile the loop over samples once for all runs; it takes ten seconds.

    Numba identifies the cached loop by this file and by the variables it closes over. The stamp is a digest of
    the source of the filters. The loop returns the stamp, so it closes over it.
    """
    stamp = stamp_of("gyrodrift.filters")

    @compiled_once()
    def follow(c: Any, s: Any, dt_s: Floats, rate_dps: Floats, still: Floats, temp_c: Floats, result: Floats) -> str:
        for n in range(len(dt_s)):
            still_now = still[n] if len(still) else np.nan
            warm_c = temp_c[n] if len(temp_c) else np.nan
            _advance(c[0], s[0], dt_s[n], rate_dps[n], still_now, warm_c)
            result[0, n] = s[0].yaw_deg
            result[1, n] = s[0].yaw_sigma_deg
            result[2, n] = s[0].bias_dps
        return stamp

    return follow


_follow = _compiled()


@compiled_once()
def _add_up(walked: Floats, reference_deg: Floats, result: Floats) -> None:
    squares = absolutes = worst = crps = 0.0
    for n in range(len(reference_deg)):
        if not np.isnan(reference_deg[n]):
            error_deg, sigma_deg = abs(walked[0, n] - reference_deg[n]), walked[1, n]
            if sigma_deg > 0.0:  # as `normal_crps`
                z = error_deg / sigma_deg
                density = exp(-0.5 * z * z) / sqrt(2.0 * pi)
                crps += sigma_deg * (z * erf(z / sqrt(2.0)) + 2.0 * density - 1.0 / sqrt(pi))
            else:
                crps += error_deg
            squares += error_deg * error_deg
            absolutes += error_deg
            worst = max(worst, error_deg)
    result[0] = squares
    result[1] = absolutes
    result[2] = worst
    result[3] = crps


KERNEL = Kernel(
    lambda _group: None,
    lambda dt_s, rate_dps, reference_deg, group, _, auxiliary: sums(dt_s, rate_dps, reference_deg, group, auxiliary),
    yaw,
    sigma,
)
