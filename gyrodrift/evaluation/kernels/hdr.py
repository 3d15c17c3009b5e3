"""HDR for many parameter vectors at once, compiled, bit for bit as `gyrodrift.filters.hdr`."""

from typing import Any

import numpy as np

from gyrodrift.evaluation.kernels.kernel import GROUP, Kernel, groups, infinite_where_yaw_overflows
from gyrodrift.evaluation.kernels.simd import is_any, load, look_up, magnitude, select, signs, splat, store, with_sign
from gyrodrift.io.compile import compiled_once
from gyrodrift.values.arrays import Floats

TABLE_SIZE = 1 << 14
"""Runs of equal signs up to this length, in samples, have their step in a table; longer runs compute it."""


def sums(dt_s: Floats, rate_dps: Floats, reference_deg: Floats, params: Floats) -> tuple[Floats, Floats, Floats, int]:
    """Yaw errors of many candidates over one session, summed over the samples that have a reference.

    Parameters
    ----------
    dt_s, rate_dps, reference_deg
        As in `Reference`, shape (n,), n ≥ 1: s, deg/s and deg.
    params
        Candidates, shape (c, 5): i_c_dps, tau_s, theta_w_dps, c1, c2.

    Returns
    -------
    squares, absolutes, worst
        Shape (c,): sum of squared errors in deg², sum of absolute errors and largest absolute error in deg; inf
        if yaw overflows.
    count
        Number of samples with a reference.

    Raises
    ------
    ValueError
        If the shapes do not match.
    """
    error_sums = np.empty((3, len(params)))
    for cut in groups(len(params)):
        group = params[cut]
        error_sums[:, cut] = group_sums(dt_s, rate_dps, reference_deg, group, new_step_table(len(group)))
    return error_sums[0], error_sums[1], error_sums[2], int(np.count_nonzero(np.isfinite(reference_deg)))


def new_step_table(candidates: int) -> Floats:
    """Empty table of the steps R(r)·i_c of a group, deg/s; the kernel fills it on demand.

    The same candidates can use it on other sessions. Threads can share it: they write the same values.
    """
    return np.zeros((_width(candidates), TABLE_SIZE))


def group_sums(dt_s: Floats, rate_dps: Floats, reference_deg: Floats, params: Floats, steps_dps: Floats) -> Floats:
    """Sums for a group of 1 to `GROUP` candidates with their step table, shape (3, c): squares, absolutes, worst."""
    unused = _width(len(params)) - len(params)
    group = np.concatenate([params, np.repeat(params[-1:], unused, axis=0)])
    return _walked(dt_s, rate_dps, reference_deg, group, steps_dps, np.empty((0, 1)))[:, : len(params)]


def yaw(dt_s: Floats, rate_dps: Floats, params: Floats) -> Floats:
    """Yaw of one candidate, deg, shape (n,); `params` has the shape (5,)."""
    path = np.zeros((len(dt_s), 1))
    _walked(dt_s, rate_dps, np.zeros(len(dt_s)), params[np.newaxis], new_step_table(1), path)
    return path[:, 0]


def _width(candidates: int) -> int:
    """Walk a single candidate without SIMD."""
    return 1 if candidates == 1 else GROUP


def _walked(
    dt_s: Floats, rate_dps: Floats, reference_deg: Floats, params: Floats, steps_dps: Floats, path_deg: Floats
) -> Floats:
    if not len(dt_s) == len(rate_dps) == len(reference_deg) > 0 or params.shape[1] != 5:
        shapes = [array.shape for array in (dt_s, rate_dps, reference_deg, params)]
        raise ValueError(f"a session needs three arrays of one length, and candidates need five columns: {shapes}")
    walk = _walk_single if len(params) == 1 else _walk_group
    columns = np.array(params.T, dtype=np.float64, order="C")
    columns[2, columns[0] == 0.0] = 0.0  # with an increment of 0 the bias stays 0, and no step is needed
    error_sums: Floats = walk(
        _read_only(dt_s), _read_only(rate_dps), _read_only(reference_deg), columns, steps_dps, path_deg
    )
    error_sums[:, np.isnan(error_sums[0])] = np.inf
    return error_sums


def _read_only(values: Floats) -> Floats:
    """Read-only view, so that arrays in memory and in a file have one type and are compiled once."""
    view = np.ascontiguousarray(values, dtype=np.float64).view()
    view.flags.writeable = False
    return view


@compiled_once()
def attenuated_step(i_c_dps: float, c1: float, c2: float, run: float) -> float:
    """R(r)·i_c in deg/s, as in `gyrodrift.filters.hdr`."""
    steepness: float = run**c2
    if np.isinf(steepness):
        return 0.0
    return (1.0 + c1) / (1.0 + c1 * steepness) * i_c_dps


@compiled_once()
def _learn_steps(params: Floats, steps_dps: Floats, runs: Any, lane_steps_dps: Floats) -> None:
    """Compute the steps that are 0; store them if the table has their run."""
    for k in range(len(lane_steps_dps)):
        if lane_steps_dps[k] == 0.0:
            lane_steps_dps[k] = attenuated_step(params[0, k], params[3, k], params[4, k], float(runs[k]))
            if runs[k] < TABLE_SIZE - 1:
                steps_dps[k, runs[k]] = lane_steps_dps[k]


def _compiled(count: int) -> Any:
    """Compile the recursion for `count` candidates.

    `params` has the shape (5, count), `steps_dps` (count, TABLE_SIZE); 0 is a step that is not
    computed yet, and its last column stays 0. `path_deg`, shape (n, count), receives yaw; with shape (0, count) yaw is
    not stored.
    """

    def walk(
        dt_s: Floats, rate_dps: Floats, reference_deg: Floats, params: Floats, steps_dps: Floats, path_deg: Floats
    ) -> Floats:
        zero, unit = splat(0.0, count), splat(1.0, count)
        none, once, last = splat(0, count), splat(1, count), splat(TABLE_SIZE - 1, count)
        tau, theta = load(params[1], count), load(params[2], count)
        runs, step_dps = np.zeros(count, np.int64), np.zeros(count)
        lpf = omega = splat(rate_dps[0], count)
        i = yaw_deg = squares = absolutes = worst = zero
        sign_before = run = none
        for n in range(1, len(dt_s)):
            t = splat(dt_s[n], count)
            before, sign = omega, signs(omega)
            run = select(sign == sign_before, run, none) + once
            sign_before = sign
            inside = magnitude(before) < theta
            if is_any(inside):
                step = look_up(steps_dps, select(run < last, run, last))
                if is_any(inside & (step == zero)):
                    store(runs, run)
                    store(step_dps, select(inside, step, unit))
                    _learn_steps(params, steps_dps, runs, step_dps)
                    step = load(step_dps, count)
                learnt = select(inside, select(before == zero, zero, step), zero)
                i = i - with_sign(learnt, before)
            lpf = (splat(rate_dps[n] * dt_s[n], count) + tau * lpf) / (t + tau)
            omega = lpf + i
            yaw_deg = yaw_deg + (omega + tau / t * (omega - before)) * t
            if n < len(path_deg):
                store(path_deg[n], yaw_deg)
            if np.isfinite(reference_deg[n]):
                error = magnitude(yaw_deg - splat(reference_deg[n], count))
                squares, absolutes = squares + error * error, absolutes + error
                worst = select(error > worst, error, worst)
        error_sums = np.empty((3, count))
        store(error_sums[0], squares)
        store(error_sums[1], absolutes)
        store(error_sums[2], worst)
        return error_sums

    # The symbol of a compiled function is its name and a counter of the process. A function from the cache and a
    # function compiled here may have the same counter, so their names must differ.
    walk.__qualname__ = f"walk_of_{count}"
    return compiled_once()(walk)


_walk_single = _compiled(1)
_walk_group = _compiled(GROUP)

KERNEL = Kernel(
    lambda group: new_step_table(len(group)),
    lambda dt_s, rate_dps, reference_deg, group, steps, _: infinite_where_yaw_overflows(
        np.vstack([group_sums(dt_s, rate_dps, reference_deg, group, steps), np.full(len(group), np.nan)])
    ),
    lambda dt_s, rate_dps, candidate, _: yaw(dt_s, rate_dps, candidate),
)
