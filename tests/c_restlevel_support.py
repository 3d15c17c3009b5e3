"""Restlevel in Python as `tests/firmware/filter_restlevel.c` runs it in C, and samples for both."""

from dataclasses import astuple
from math import nan

import numpy as np
from c_filter_support import FilterOutput
from numpy.typing import NDArray

from gyrodrift.filters.gaps import UNKNOWN_S, expect_gap
from gyrodrift.filters.restlevel.model import RestlevelParams, RestlevelState
from gyrodrift.filters.restlevel.step import coefficients, step
from gyrodrift.filters.restlevel.zero import zero_yaw
from gyrodrift.values.arrays import Floats

YAW, SIGMA, BIAS = 0, 1, 2
"""Columns of the outputs."""

ZERO, GAP, RESTARTED = 1.0, 2.0, 3.0
"""Commands after a sample."""


def samples(rate_dps: Floats, still: Floats | None = None, temp_c: Floats | None = None) -> Floats:
    """Inputs of the filter, shape (samples, 4): rate, rest, temperature, and a command after it."""
    inputs = np.full((len(rate_dps), 4), nan)
    inputs[:, 0] = rate_dps
    for column, values in ((1, still), (2, temp_c)):
        if values is not None:
            inputs[:, column] = values
    return inputs


def in_python(
    t_s: Floats, inputs: Floats, params: RestlevelParams | None = None, state: RestlevelState | None = None
) -> FilterOutput:
    """Outputs of the Python filter."""
    c, s = coefficients(params or RestlevelParams()), state or RestlevelState()
    taken, rows = [], []
    for t, (rate_dps, still, temp_c, command) in zip(t_s.tolist(), inputs.tolist(), strict=True):
        taken.append(step(c, s, t, rate_dps, still, temp_c))
        if command == ZERO:
            zero_yaw(s)
        elif command in {GAP, RESTARTED} and s.samples > 0:
            expect_gap(s.watch, UNKNOWN_S, has_restarted=command == RESTARTED)
        rows.append(outputs_of(s))
    return FilterOutput(True, np.array(taken), np.array(rows))


def outputs_of(s: RestlevelState) -> tuple[float, ...]:
    """Outputs in the order of the C program."""
    moments = (s.yaw_deg, s.yaw_sigma_deg, s.bias_dps, s.bias_sigma_dps)
    counts = (s.samples, s.rejected, s.witness.refuted, s.line.slope_dps_c)
    return (*moments, s.rest_probability, s.confidence, *counts, s.correction_deg, s.corrections)


def values_of(params: RestlevelParams) -> list[float]:
    """Parameters in the order of the C struct."""
    return [float(value) for value in astuple(params)]


def drive(rng: np.random.Generator, t_s: Floats, turn_dps: float = 60.0) -> tuple[Floats, NDArray[np.bool_]]:
    """True rate of rests and turns of some seconds, and where it is a rest; a long first rest."""
    rate_dps, is_rest = np.zeros(len(t_s)), np.ones(len(t_s), dtype=bool)
    begin_s, resting = 0.0, True
    while begin_s < t_s[-1]:
        seconds = rng.uniform(3.0, 20.0)
        inside = (t_s >= begin_s) & (t_s < begin_s + seconds)
        if not resting:
            gone_s = t_s[inside] - begin_s
            level = rng.uniform(-1.0, 1.0) * turn_dps
            ramp = np.minimum(1.0, np.minimum(gone_s, seconds - gone_s))
            rate_dps[inside] = level * ramp * (1.0 + 0.5 * np.sin(gone_s * rng.uniform(0.3, 3.0)))
            is_rest[inside] = False
        begin_s, resting = begin_s + seconds, not resting
    return rate_dps, is_rest


def measured(
    rng: np.random.Generator, rate_dps: Floats, bias_dps: float = 0.3, step_dps: float = 1.0 / 131.0
) -> Floats:
    """Rates of a sensor with noise, a bias that walks, and steps; 0 for no steps."""
    walk_dps = np.cumsum(rng.normal(0.0, 2e-4, len(rate_dps)))
    read_dps = rate_dps + bias_dps + walk_dps + rng.normal(0.0, 0.06, len(rate_dps))
    return np.asarray(np.rint(read_dps / step_dps) * step_dps if step_dps else read_dps)
