"""The filters there are, by the names that a config gives them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

from gyrodrift.filters import hdr
from gyrodrift.filters.restlevel import model as restlevel
from gyrodrift.filters.restlevel import step as restlevel_step


class FilterState(Protocol):
    """What every filter tells after a sample.

    yaw_deg, yaw_sigma_deg
        Yaw and its standard deviation, deg; NaN for a filter that does not know how certain it is.
    bias_dps
        The drift estimate, deg/s.
    confidence
        Probability of what the filter believes has happened; NaN likewise.
    """

    yaw_deg: float
    samples: int
    rejected: int

    @property
    def bias_dps(self) -> float:  # noqa: D102 - above
        ...

    @property
    def yaw_sigma_deg(self) -> float:  # noqa: D102
        ...

    @property
    def confidence(self) -> float:  # noqa: D102
        ...


@dataclass(frozen=True, slots=True)
class Filter:
    """One of them: three records and a step.

    coefficients
        From parameters to what is worked out once.
    step
        Takes coefficients, state, device time in s and rate in deg/s; False where the sample was passed by.
    columns
        Attributes of the state that `gyrodrift filter` writes beside time and rate.
    counts_samples
        Whether its parameters belong to the sample rate they were found at.
    """

    name: str
    params: type[Any]
    coefficients: Callable[[Any], Any]
    state: Callable[[], Any]
    step: Callable[[Any, Any, float, float], bool]
    columns: tuple[str, ...]
    counts_samples: bool = False


HDR = Filter(
    "hdr",
    hdr.HdrParams,
    hdr.coefficients,
    hdr.HdrState,
    hdr.step,
    ("lpf_dps", "i_dps", "omega_dps", "omega_d_dps", "yaw_deg"),
    counts_samples=True,
)

RESTLEVEL = Filter(
    "restlevel",
    restlevel.RestlevelParams,
    restlevel_step.coefficients,
    restlevel.RestlevelState,
    restlevel_step.step,
    ("bias_dps", "bias_sigma_dps", "rest_probability", "confidence", "yaw_deg", "yaw_sigma_deg"),
)

Params = hdr.HdrParams | restlevel.RestlevelParams

FILTERS: Mapping[str, Filter] = {each.name: each for each in (HDR, RESTLEVEL)}
