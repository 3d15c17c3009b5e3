"""A filter that subtracts a constant bias from the rate."""

from dataclasses import dataclass
from math import isfinite, nan
from typing import Annotated, ClassVar

from annotated_types import Ge, Le

from gyrodrift.filters.filter import Filter, FilterParameter, SearchRange


@dataclass(frozen=True, slots=True)
class ConstantParams:
    """bias_dps: subtracted from every rate, deg/s."""

    bias_dps: Annotated[float, Ge(-10.0), Le(10.0)] = 0.0


@dataclass(slots=True)
class ConstantState:
    """All values that change from sample to sample."""

    yaw_sigma_deg: ClassVar[float] = nan
    bias_sigma_dps: ClassVar[float] = nan
    rest_probability: ClassVar[float] = nan
    confidence: ClassVar[float] = nan

    t_s: float = 0.0
    yaw_deg: float = 0.0
    bias_dps: float = 0.0
    samples: int = 0
    rejected: int = 0


def step(p: ConstantParams, s: ConstantState, t_s: float, rate_dps: float) -> bool:
    """Advance by one sample; False if the sample was rejected."""
    dt_s = t_s - s.t_s if s.samples else 0.0
    if not (isfinite(t_s) and isfinite(rate_dps)) or (s.samples and dt_s <= 0.0):
        s.rejected += 1
        return False
    s.yaw_deg += (rate_dps - p.bias_dps) * dt_s
    s.t_s, s.bias_dps = t_s, p.bias_dps
    s.samples += 1
    return True


CONSTANT = Filter(
    name="constant",
    params=ConstantParams,
    state=ConstantState,
    step=step,
    columns=("bias_dps", "yaw_deg"),
    parameters=(
        FilterParameter(
            "bias_dps",
            "deg/s",
            "subtracted from every rate, deg/s",
            "The bias of the sensor, if it never changed.",
            "it takes sessions with a drift",
            SearchRange(-5.0, 5.0),
        ),
    ),
    baseline=ConstantParams(0.0),
    title="constant bias",
)
