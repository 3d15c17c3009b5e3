"""Filter `fixed`: subtracts a constant bias from the rate."""

from dataclasses import dataclass
from math import isfinite, nan
from typing import Annotated

from annotated_types import Ge, Le

from gyrodrift.filters.filter import Filter, FilterParameter, SearchRange

GYRODRIFT_API = 1


@dataclass(frozen=True, slots=True)
class FixedParams:
    """bias_dps: subtracted from every rate, deg/s."""

    bias_dps: Annotated[float, Ge(-10.0), Le(10.0)] = 0.0


@dataclass
class FixedState:
    """Yaw and bias; the filter knows no uncertainty."""

    t_s: float = 0.0
    yaw_deg: float = 0.0
    bias_dps: float = 0.0
    samples: int = 0
    rejected: int = 0
    yaw_sigma_deg = bias_sigma_dps = rest_probability = confidence = nan


def step(p: FixedParams, s: FixedState, t_s: float, rate_dps: float) -> bool:
    """Advance by one sample; False if the sample was rejected."""
    if not (isfinite(t_s) and isfinite(rate_dps)) or (s.samples and t_s <= s.t_s):
        s.rejected += 1
        return False
    s.yaw_deg += (rate_dps - p.bias_dps) * (t_s - s.t_s if s.samples else 0.0)
    s.t_s, s.bias_dps, s.samples = t_s, p.bias_dps, s.samples + 1
    return True


BIAS = FilterParameter("bias_dps", "deg/s", "bias", "the bias", "it takes a rest", SearchRange(-5.0, 5.0))
COLUMNS = ("bias_dps", "yaw_deg")
FIXED = Filter("fixed", FixedParams, FixedState, step, COLUMNS, (BIAS,), FixedParams(), title="fixed bias")
