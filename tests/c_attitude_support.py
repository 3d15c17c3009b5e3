"""The attitude filter in Python as `tests/firmware/filter_attitude.c` runs it in C, and samples for both."""

from dataclasses import astuple
from math import nan

import numpy as np
from c_filter_support import FilterOutput
from c_restlevel_support import GAP, RESTARTED, ZERO
from numpy.typing import NDArray

from gyrodrift.filters.attitude.model import AttitudeState
from gyrodrift.filters.attitude.step import coefficients, step
from gyrodrift.filters.attitude.zero import zero_yaw
from gyrodrift.filters.gaps import UNKNOWN_S, expect_gap
from gyrodrift.filters.restlevel.model import RestlevelParams
from gyrodrift.values.arrays import Floats

YAW, SIGMA, BIAS, BIAS_SIGMA, TILT, TILT_SIGMA, REST, CONFIDENCE = range(8)
STILL, TEMPERATURE, COMMAND = 6, 7, 8
"""Columns of the inputs after rates and accelerations."""

Q, COUNTS = slice(12, 16), slice(16, 20)
"""Columns of the outputs; the counts are hypotheses, samples, rejected samples, and contradictions of a rest sensor."""


def samples(
    gyro_dps: Floats, accel_mps2: Floats, still: Floats | None = None, zeros: NDArray[np.int64] | None = None
) -> Floats:
    """Inputs of the filter, shape (samples, 9); `zeros` are the samples after which the yaw sigma restarts.

    The last column is a command after the sample, as in `c_restlevel_support`.
    """
    inputs = np.full((len(gyro_dps), 9), nan)
    inputs[:, :3], inputs[:, 3:6] = gyro_dps, accel_mps2
    if still is not None:
        inputs[:, STILL] = still
    if zeros is not None:
        inputs[zeros, COMMAND] = 1.0
    return inputs


def in_python(
    t_s: Floats, inputs: Floats, params: RestlevelParams | None = None, state: AttitudeState | None = None
) -> FilterOutput:
    """Outputs of the Python filter."""
    c, s = coefficients(params or RestlevelParams()), state or AttitudeState()
    taken, rows = [], []
    for t, (*values, command) in zip(t_s.tolist(), inputs.tolist(), strict=True):
        taken.append(step(c, s, t, *values))
        if command == ZERO:
            zero_yaw(s)
        elif command in {GAP, RESTARTED} and s.samples > 0:
            expect_gap(s.watch, UNKNOWN_S, has_restarted=command == RESTARTED)
        rows.append(outputs_of(s))
    return FilterOutput(True, np.array(taken), np.array(rows))


def outputs_of(s: AttitudeState) -> tuple[float, ...]:
    """Outputs in the order of the C program."""
    heading = (s.yaw_deg, s.yaw_sigma_deg, s.bias_dps, s.bias_sigma_dps)
    rest = (s.tilt_deg, s.tilt_sigma_deg, s.rest_probability, s.confidence, s.heading_rate_dps)
    counts = (len(s.hypotheses.weight), s.samples, s.rejected, s.witness.refuted)
    changes = (s.correction_deg, s.corrections, s.watch.restarts > 0)
    slopes = (axis.line.slope_dps_c for axis in s.axes)
    return (*heading, *rest, *s.bias_xyz_dps, *s.q, *counts, s.yaw_deg, *changes, *s.bias_sigma_xyz_dps, *slopes)


def values_of(params: RestlevelParams) -> list[float]:
    """Parameters in the order of the C struct."""
    return [float(value) for value in astuple(params)]
