"""HDR, heuristic drift reduction: one recursion in plain floats.

`serve` steps it once a sample, and `filter` runs it over a recording. A test compares every batch version bit for bit.

Source: J. Borenstein and L. Ojeda, "Heuristic reduction of gyro drift in vehicle tracking applications",
Int. J. Vehicle Information and Communication Systems 2(1/2), 2009, DOI 10.1504/IJVICS.2009.027747, in the form
with a low-pass filter, a turn switch and a repetition attenuator (equations 1 to 8, docs/filters.md). With T the time
since the sample before:

```
    r       = r + 1 if SIGN(omega) equals that of the sample before, else 1
    W       = 1 if |omega| < theta_w, else 0                                  the turn switch
    R       = (1 + c1)/(1 + c1·r^c2)                                          the repetition attenuator
    I       = I − SIGN(omega)·W·R·i_c                                         the integrator: less the drift
    lpf     = (raw·T + tau·lpf)/(T + tau)                                     the low-pass
    omega   = lpf + I
    omega_d = omega + tau/T·(omega − omega before)                            the low-pass undone
    yaw     = yaw + omega_d·T
```
"""

from dataclasses import dataclass
from math import nan
from typing import Annotated, ClassVar

from annotated_types import Ge, Gt, Le

from gyrodrift.filters.limits import LEAST_STEP_S, MOST_DPS, MOST_S

ATTENUATOR_TABLE = 512
"""Longest run of equal signs whose step is in a table; longer runs compute it. Chosen: longer runs are rare."""


@dataclass(frozen=True, slots=True)
class HdrParams:
    """Parameters of HDR. The defaults are the published values, read in deg/s.

    i_c_dps
        Integrator increment per sample, deg/s. Small: learns slowly. Large: the estimate oscillates.
        It is valid for the sample rate of its tuning.
    tau_s
        Time constant of the low-pass filter before the decision, s. 0 decides on the raw rate.
    theta_w_dps
        Turn switch, deg/s: no learning above this rate. A larger bias is never learned; a slower turn is taken for
        drift.
    c1, c2
        Repetition attenuator, dimensionless: how strongly (c1) and how steeply (c2) the step shrinks while the
        filtered rate keeps one sign. c1 = 0 switches it off.
    """

    i_c_dps: Annotated[float, Ge(0.0), Le(10.0)] = 0.0006
    tau_s: Annotated[float, Ge(0.0), Le(1000.0)] = 0.9447
    theta_w_dps: Annotated[float, Gt(0.0), Le(2000.0)] = 0.5608
    c1: Annotated[float, Ge(0.0), Le(1000.0)] = 0.7839
    c2: Annotated[float, Ge(0.0), Le(10.0)] = 1.2161


@dataclass(frozen=True, slots=True)
class HdrCoefficients:
    """Values computed once from the parameters.

    `steps_dps[r]` is R(r)·i_c in deg/s, attenuator times increment, for a run of r equal signs.
    """

    params: HdrParams
    steps_dps: tuple[float, ...]


@dataclass(slots=True)
class HdrState:
    """State of the filter; a copy of it saves the filter.

    t_s, lpf_dps, i_dps, omega_dps, omega_d_dps, yaw_deg
        The columns of the recursion after the last accepted sample.
    sign_before
        SIGN of omega one sample earlier than `omega_dps`.
    run
        r, the number of equal signs in a row.
    samples, rejected
        Samples accepted, and samples rejected because T ≤ 0, or the rate or time is not finite or out of its limits.
    yaw_sigma_deg, bias_sigma_dps, rest_probability, confidence
        NaN: the filter has no uncertainty.
    """

    yaw_sigma_deg: ClassVar[float] = nan
    bias_sigma_dps: ClassVar[float] = nan
    rest_probability: ClassVar[float] = nan
    confidence: ClassVar[float] = nan

    t_s: float = 0.0
    lpf_dps: float = 0.0
    i_dps: float = 0.0
    omega_dps: float = 0.0
    omega_d_dps: float = 0.0
    yaw_deg: float = 0.0
    sign_before: int = 0
    run: int = 1
    samples: int = 0
    rejected: int = 0

    @property
    def bias_dps(self) -> float:
        """The drift estimate, −I, deg/s; never −0."""
        return 0.0 - self.i_dps


def attenuated_step(params: HdrParams, run: int) -> float:
    """R(r)·i_c in deg/s for a run of `run` equal signs; 0 if r^c2 overflows."""
    try:
        steepness: float = float(run) ** params.c2
    except OverflowError:
        return 0.0
    return (1.0 + params.c1) / (1.0 + params.c1 * steepness) * params.i_c_dps


def coefficients(params: HdrParams) -> HdrCoefficients:
    """Compute the coefficients from the parameters."""
    return HdrCoefficients(params, tuple(attenuated_step(params, run) for run in range(ATTENUATOR_TABLE)))


def step(c: HdrCoefficients, s: HdrState, t_s: float, rate_dps: float) -> bool:
    """Advance the state by one sample.

    Parameters
    ----------
    c, s
        Coefficients, and the state, which is updated in place.
    t_s
        Device time in s. T is its distance from the last accepted sample.
    rate_dps
        Measured rate, deg/s, counter-clockwise positive. Plain floats, like `t_s`: numpy scalars take three
        times as long.

    Returns
    -------
    bool
        False if the sample is rejected (T ≤ 0, or a value that is not finite or out of its limits). It is counted in
        `s.rejected` and does not change the recursion.
    """
    if s.samples == 0:
        return _first(s, t_s, rate_dps)
    dt_s = t_s - s.t_s
    if not (dt_s >= LEAST_STEP_S and t_s <= MOST_S and -MOST_DPS <= rate_dps <= MOST_DPS):
        s.rejected += 1
        return False
    p = c.params
    omega_before = s.omega_dps
    sign = (omega_before > 0.0) - (omega_before < 0.0)
    s.run = s.run + 1 if s.samples >= 2 and sign == s.sign_before else 1
    if abs(omega_before) < p.theta_w_dps:
        step_dps = c.steps_dps[s.run] if s.run < ATTENUATOR_TABLE else attenuated_step(p, s.run)
        s.i_dps -= sign * step_dps
    s.lpf_dps = (rate_dps * dt_s + p.tau_s * s.lpf_dps) / (dt_s + p.tau_s)
    s.omega_dps = s.lpf_dps + s.i_dps
    s.omega_d_dps = s.omega_dps + p.tau_s / dt_s * (s.omega_dps - omega_before)
    s.yaw_deg += s.omega_d_dps * dt_s
    s.sign_before = sign
    s.t_s = t_s
    s.samples += 1
    return True


def _first(s: HdrState, t_s: float, rate_dps: float) -> bool:
    if not (-MOST_S <= t_s <= MOST_S and -MOST_DPS <= rate_dps <= MOST_DPS):
        s.rejected += 1
        return False
    s.t_s = t_s
    s.lpf_dps = s.omega_dps = s.omega_d_dps = rate_dps
    s.samples = 1
    return True
