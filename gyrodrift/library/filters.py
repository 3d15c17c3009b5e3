"""The filters as objects for other programs: the very step that `serve` runs, sample by sample or over arrays."""

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from math import isfinite
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Self

from gyrodrift.errors import UsageError
from gyrodrift.filters.filter import Filter, FilterParams, FilterState
from gyrodrift.filters.hdr_filter import HDR
from gyrodrift.filters.restlevel_filter import RESTLEVEL

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from gyrodrift.arrays import Floats, Mask


class Estimate(NamedTuple):
    """What a filter believes after a sample; NaN where it does not say how certain it is.

    yaw_deg, yaw_sigma_deg
        Unwrapped yaw, counter-clockwise positive, 0 at the first sample, and its standard deviation, deg.
    bias_dps, bias_sigma_dps
        The drift estimate and its standard deviation, deg/s.
    rest_probability, confidence
        Probability that the device is at rest, and of what the filter believes has happened.
    is_accepted
        False where the sample was passed by: time that does not go on, or a value that is not finite.
    """

    yaw_deg: float
    yaw_sigma_deg: float
    bias_dps: float
    bias_sigma_dps: float
    rest_probability: float
    confidence: float
    is_accepted: bool


@dataclass(frozen=True, slots=True)
class Estimates:
    """`Estimate` as arrays of the shape (n,): a row for every sample, those that were passed by too."""

    yaw_deg: "Floats"
    yaw_sigma_deg: "Floats"
    bias_dps: "Floats"
    bias_sigma_dps: "Floats"
    rest_probability: "Floats"
    confidence: "Floats"
    is_accepted: "Mask"


class DriftFilter:
    """A filter and all that it has learnt.

    Parameters
    ----------
    params
        All of them in one record, as a tuning or a config gives them; None for the defaults.
    changes
        Single parameters by their names in the config, such as `theta_w_dps=0.7`.

    Raises
    ------
    UsageError
        Where there is no such parameter, or it is out of its bounds.
    """

    filter: ClassVar[Filter]

    def __init__(self, params: FilterParams | None = None, **changes: float) -> None:
        self.params: FilterParams = _checked(self.filter, params, changes)
        self._coefficients = self.filter.coefficients(self.params)
        self.reset()

    @classmethod
    def from_config(cls, path: str | PathLike[str]) -> Self:
        """With what a config says of this filter, whichever filter it runs.

        Raises
        ------
        ConfigError
            With every mistake of the file.
        """
        from gyrodrift.config.model import load_config

        return cls(load_config(Path(path)).params_of(cls.filter))

    def reset(self) -> None:
        """Begin anew: yaw is 0 at the next sample, and nothing is learnt yet."""
        self.state: FilterState = self.filter.state()
        self._t_s = 0.0

    def update(self, rate_dps: float, dt_s: float) -> Estimate:
        """Take one sample.

        Parameters
        ----------
        rate_dps
            Measured rate, deg/s, counter-clockwise positive.
        dt_s
            Time since the sample before, s; that of the first sample only says when time begins.
        """
        return self.update_at(rate_dps, self._t_s + float(dt_s))

    def update_at(self, rate_dps: float, t_s: float) -> Estimate:
        """Take one sample with its time on the device clock, s: the bits of `serve` over the same samples."""
        return Estimate(*self._taken(float(rate_dps), float(t_s)))

    def update_batch(self, rate_dps: "ArrayLike", t_s: "ArrayLike") -> Estimates:
        """Take many samples: the same as `update_at` with each.

        Parameters
        ----------
        rate_dps, t_s
            Rates in deg/s and times on the device clock in s, shape (n,).

        Raises
        ------
        UsageError
            Where they are no two series of numbers of one length.
        """
        import numpy as np

        rates, times = _series("rate_dps", rate_dps), _series("t_s", t_s)
        if len(rates) != len(times):
            raise UsageError(f"update_batch: {len(rates)} rates and {len(times)} times; each rate needs its time")
        columns = np.empty((len(Estimate._fields), len(rates)))
        for at, (rate, time) in enumerate(zip(rates.tolist(), times.tolist(), strict=True)):
            columns[:, at] = self._taken(rate, time)
        yaw, yaw_sigma, bias, bias_sigma, rest, confidence, is_accepted = columns
        return Estimates(yaw, yaw_sigma, bias, bias_sigma, rest, confidence, is_accepted == 1.0)

    def _taken(self, rate_dps: float, t_s: float) -> tuple[float, float, float, float, float, float, bool]:
        s = self.state
        is_accepted = self.filter.step(self._coefficients, s, t_s, rate_dps)
        if (isfinite(t_s) and t_s > self._t_s) or (is_accepted and s.samples == 1):
            self._t_s = t_s
        return (
            s.yaw_deg,
            s.yaw_sigma_deg,
            s.bias_dps,
            s.bias_sigma_dps,
            s.rest_probability,
            s.confidence,
            is_accepted,
        )


class Hdr(DriftFilter):
    """Heuristic drift reduction: small, fast, without any need for rests, and silent about its certainty."""

    filter = HDR


class Restlevel(DriftFilter):
    """Looks for rests, keeps several hypotheses of what was one, and tells how certain it is."""

    filter = RESTLEVEL


def _checked(chosen: Filter, params: FilterParams | None, changes: dict[str, float]) -> FilterParams:
    if params is not None and not isinstance(params, chosen.params):
        raise UsageError(f"{chosen.name}: parameters are a {chosen.params.__name__}, not a {type(params).__name__}")
    problems = list(_problems(chosen, asdict(params) if params is not None else {}, changes))
    if problems:
        raise UsageError("\n".join(problems))
    whole: dict[str, Any] = asdict(params) if params is not None else {}
    record: FilterParams = chosen.params(**{name: float(value) for name, value in (whole | changes).items()})
    return record


def _problems(chosen: Filter, whole: dict[str, float], changes: dict[str, float]) -> Iterator[str]:
    """What the config would say of the same values."""
    from pydantic import TypeAdapter, ValidationError

    from gyrodrift.config.explain import unknown_key

    for name in changes.keys() - set(chosen.names):
        yield f"{chosen.name}: {name} {unknown_key(name, list(chosen.names), f'a parameter of {chosen.name}')}"
    known = {name: value for name, value in (whole | changes).items() if name in chosen.names}
    try:
        TypeAdapter(chosen.params).validate_python(known)
    except ValidationError as error:
        for one in error.errors():
            yield f"{chosen.name}: {'.'.join(map(str, one['loc']))}: {one['msg']}, not {one['input']!r}"


def _series(name: str, given: "ArrayLike") -> "Floats":
    import numpy as np

    try:
        values = np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise UsageError(f"update_batch: {name} is no series of numbers: {error}") from error
    if values.ndim != 1:
        raise UsageError(f"update_batch: {name} has the shape {values.shape}; expected (n,)")
    return values
