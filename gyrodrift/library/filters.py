"""Filters as objects: the step that `serve` runs, sample by sample or over arrays."""

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from math import isfinite, nan
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Self

from gyrodrift.filters.filter import Filter, FilterParams, FilterState
from gyrodrift.filters.hdr_filter import HDR
from gyrodrift.filters.restlevel_filter import RESTLEVEL
from gyrodrift.filters.run import FilterRun
from gyrodrift.io.result_table import ResultTable
from gyrodrift.library.second_sources import SecondSources
from gyrodrift.values.errors import UsageError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from gyrodrift.values.arrays import Floats, Mask


class Estimate(NamedTuple):
    """State of a filter after a sample; NaN for a quantity that the filter does not estimate.

    yaw_deg, yaw_sigma_deg
        Unwrapped yaw, counter-clockwise positive, 0 at the first sample, and its standard deviation, deg.
    bias_dps, bias_sigma_dps
        Bias of the rate and its standard deviation, deg/s.
    rest_probability, confidence
        Probability that the device is at rest, and of the filter's most probable hypothesis.
    is_accepted
        False if the sample was rejected: its time does not increase, or a value is not finite.
    correction_deg
        Step of yaw in this sample that is no motion, deg: a change of the estimate. 0 else.
    """

    yaw_deg: float
    yaw_sigma_deg: float
    bias_dps: float
    bias_sigma_dps: float
    rest_probability: float
    confidence: float
    is_accepted: bool
    correction_deg: float = 0.0


@dataclass(frozen=True, slots=True, repr=False)
class Estimates(ResultTable):
    """The fields of `Estimate` as arrays of shape (n,), one row for each sample, rejected ones included."""

    yaw_deg: "Floats"
    yaw_sigma_deg: "Floats"
    bias_dps: "Floats"
    bias_sigma_dps: "Floats"
    rest_probability: "Floats"
    confidence: "Floats"
    is_accepted: "Mask"
    correction_deg: "Floats"

    def __repr__(self) -> str:
        count, end = len(self.yaw_deg), f", yaw ends at {self.yaw_deg[-1]:.3f} deg" if len(self.yaw_deg) else ""
        return f"Estimates({count} samples{end})"

    def columns(self) -> dict[str, Any]:
        """The arrays by name."""
        return {name: getattr(self, name) for name in Estimate._fields}


class DriftFilter(SecondSources):
    """A filter with its state.

    Parameters
    ----------
    params
        All parameters in one record, as `tune` and a config give them; None for the defaults.
    changes
        Single parameters by name; None leaves a parameter as it is.

    Raises
    ------
    UsageError
        If a parameter does not exist or is out of its bounds.
    """

    filter: ClassVar[Filter]

    def __init__(self, params: FilterParams | None = None, **changes: float | None) -> None:
        given = {name: value for name, value in changes.items() if value is not None}
        self.params: FilterParams = checked_params(self.filter, params, given)
        self.reset()

    def __repr__(self) -> str:
        defaults = asdict(self.filter.params())
        changed = [f"{name}={value:g}" for name, value in asdict(self.params).items() if value != defaults[name]]
        return f"{type(self).__name__}({', '.join(changed)})"

    @classmethod
    def from_config(cls, path: str | PathLike[str]) -> Self:
        """Filter with its parameters in a config, even if the config runs another filter.

        Raises
        ------
        ConfigError
            With every mistake of the file.
        """
        from gyrodrift.config.model import load_config

        return cls(load_config(Path(path)).params_of(cls.filter))

    def reset(self) -> None:
        """Reset the state: yaw is 0 at the next sample, and the bias is unknown."""
        self._run = FilterRun(self.filter, self.params, "1")
        self._t_s = 0.0

    @property
    def state(self) -> FilterState:
        """State after the last sample; a deep copy saves it."""
        state: FilterState = self._run.state
        return state

    @property
    def corrections(self) -> int:
        """Number of corrections of yaw over 1 deg so far."""
        return self._run.corrections

    def gap(self) -> None:
        """Hold yaw over the next step: samples are missing before the next one, whatever its time is.

        The uncertainty of yaw grows by what a device may turn in the step. If the step is as short as the others, it
        grows to a whole circle. A step that is much longer than the others is a gap in any case.
        """
        self._run.gap()

    def restarted(self) -> None:
        """Hold yaw like `gap`, and forget the bias: the device was switched on again, or is another one.

        The bias has its turn-on prior again, around the last estimate. The next sample may have any time.
        """
        self._run.gap(has_restarted=True)

    def update(self, rate_dps: float, dt_s: float, temp_c: float = nan) -> Estimate:
        """Take one sample.

        Parameters
        ----------
        rate_dps
            Measured rate, deg/s, counter-clockwise positive.
        dt_s
            Time since the sample before, s; for the first sample it only sets the start of time.
        temp_c
            Temperature of the sensor, °C, which the bias of restlevel follows; NaN if it is unknown.
        """
        return self.update_at(rate_dps, self._t_s + float(dt_s), temp_c)

    def update_at(self, rate_dps: float, t_s: float, temp_c: float = nan) -> Estimate:
        """Take one sample with its device time, s, and temperature, °C; gives the same bits as `serve`."""
        return Estimate(*self._taken(float(rate_dps), float(t_s), float(temp_c)))

    def update_batch(self, rate_dps: "ArrayLike", t_s: "ArrayLike", temp_c: "ArrayLike | None" = None) -> Estimates:
        """Take many samples, as `update_at` would one by one.

        Parameters
        ----------
        rate_dps, t_s
            Rates in deg/s and times on the device clock in s, shape (n,).
        temp_c
            Temperatures of the sensor, °C, shape (n,); None if they are unknown.

        Raises
        ------
        UsageError
            If the arrays are not numbers of the same length.
        """
        import numpy as np

        rates, times = _series("rate_dps", rate_dps), _series("t_s", t_s)
        if len(rates) != len(times):
            raise UsageError(f"update_batch: {len(rates)} rates and {len(times)} times; each rate needs its time")
        temps = np.full(len(rates), nan) if temp_c is None else _series("temp_c", temp_c)
        if len(temps) != len(rates):
            raise UsageError(f"update_batch: {len(rates)} rates and {len(temps)} temperatures")
        columns = np.empty((len(Estimate._fields), len(rates)))
        for row, sample in enumerate(zip(rates.tolist(), times.tolist(), temps.tolist(), strict=True)):
            columns[:, row] = self._taken(*sample)
        yaw, yaw_sigma, bias, bias_sigma, rest, confidence, is_accepted, correction = columns
        return Estimates(yaw, yaw_sigma, bias, bias_sigma, rest, confidence, is_accepted == 1.0, correction)

    def _taken(
        self, rate_dps: float, t_s: float, temp_c: float
    ) -> tuple[float, float, float, float, float, float, bool, float]:
        run, restarts = self._run, self._run.restarts
        is_accepted = run.step(t_s, rate_dps, temp_c=temp_c)
        s = run.state
        has_begun = is_accepted and (s.samples == 1 or run.restarts > restarts)
        if (isfinite(t_s) and t_s > self._t_s) or has_begun:
            self._t_s = t_s
        return (
            s.yaw_deg,
            s.yaw_sigma_deg,
            s.bias_dps,
            s.bias_sigma_dps,
            s.rest_probability,
            s.confidence,
            is_accepted,
            run.correction_deg if is_accepted else 0.0,
        )


class Hdr(DriftFilter):
    """Heuristic drift reduction: small and fast, needs no rest, gives no uncertainty.

    Parameters
    ----------
    params : HdrParams, optional
        All parameters in one record.
    i_c_dps : float, default 0.0006
        Integrator step per sample, deg/s. Large: learns fast and oscillates.
    tau_s : float, default 0.9447
        Time constant of the low-pass before the sign is taken, s.
    theta_w_dps : float, default 0.5608
        No learning above this rate, deg/s. A larger bias is never learned.
    c1 : float, default 0.7839
        Attenuation of repeated steps of one sign. 0: no attenuation.
    c2 : float, default 1.2161
        Exponent of the attenuation.

    Raises
    ------
    UsageError
        If a parameter does not exist or is out of its bounds.

    Examples
    --------
    >>> estimate = Hdr(tau_s=0.5).update(rate_dps=0.2, dt_s=0.01)
    """

    filter = HDR

    def __init__(
        self,
        params: FilterParams | None = None,
        *,
        i_c_dps: float | None = None,
        tau_s: float | None = None,
        theta_w_dps: float | None = None,
        c1: float | None = None,
        c2: float | None = None,
        **unknown: float,
    ) -> None:
        super().__init__(params, i_c_dps=i_c_dps, tau_s=tau_s, theta_w_dps=theta_w_dps, c1=c1, c2=c2, **unknown)


class Restlevel(DriftFilter):
    """Learns the bias at rest with several hypotheses, and gives the uncertainty of yaw and bias.

    Parameters
    ----------
    params : RestlevelParams, optional
        All parameters in one record.
    window_s : float, default 0.3
        Length of the blocks tested for rest, s. Small: finds short stops. Large: averages more noise.
    quiet : float, default 5.0
        Variance of a block above that of the noise, in standard errors, up to which the block counts as rest.
    turn_on_dps : float, default 0.5
        Standard deviation of the bias at power-on, deg/s (0.5 is 1800 °/h). 0: the sensor subtracts its own bias.
    walk_dps_rts : float, default 0.0005
        Random walk of the bias, deg/s/√s (0.0005 is 108 °/h/√h).
    drift_dps_s : float, default 0.004
        Fastest drift of the bias, deg/s².
    still_start : float, default 0.99
        Probability that the device is at rest at the first sample.
    rest_share : float, default 0.2
        Probability that a later constant rate is a rest.
    scale_percent : float, default 1.0
        Standard deviation of the scale factor, %. It changes only `yaw_sigma_deg`.

    Raises
    ------
    UsageError
        If a parameter does not exist or is out of its bounds.

    Examples
    --------
    >>> estimates = Restlevel(turn_on_dps=2.0).update_batch(rate_dps=[0.2, 0.2], t_s=[0.0, 0.01])
    """

    filter = RESTLEVEL

    def __init__(
        self,
        params: FilterParams | None = None,
        *,
        window_s: float | None = None,
        quiet: float | None = None,
        turn_on_dps: float | None = None,
        walk_dps_rts: float | None = None,
        drift_dps_s: float | None = None,
        still_start: float | None = None,
        rest_share: float | None = None,
        scale_percent: float | None = None,
        **unknown: float,
    ) -> None:
        super().__init__(
            params,
            window_s=window_s,
            quiet=quiet,
            turn_on_dps=turn_on_dps,
            walk_dps_rts=walk_dps_rts,
            drift_dps_s=drift_dps_s,
            still_start=still_start,
            rest_share=rest_share,
            scale_percent=scale_percent,
            **unknown,
        )


def checked_params(chosen: Filter, params: FilterParams | None, changes: dict[str, float]) -> FilterParams:
    """A record of parameters with these changes.

    Raises
    ------
    UsageError
        With every parameter that does not exist or is out of its bounds.
    """
    if params is not None and not isinstance(params, chosen.params):
        raise UsageError(f"{chosen.name}: parameters are a {chosen.params.__name__}, not a {type(params).__name__}")
    problems = list(_problems(chosen, asdict(params) if params is not None else {}, changes))
    if problems:
        raise UsageError("\n".join(problems))
    whole: dict[str, Any] = asdict(params) if params is not None else {}
    record: FilterParams = chosen.params(**{name: float(value) for name, value in (whole | changes).items()})
    return record


def _problems(chosen: Filter, whole: dict[str, float], changes: dict[str, float]) -> Iterator[str]:
    """Messages of the config check for these values."""
    from pydantic import TypeAdapter, ValidationError

    from gyrodrift.config.explain import unknown_key

    for name in changes.keys() - set(chosen.names):
        yield f"{chosen.name}: {name} {unknown_key(name, list(chosen.names), f'a parameter of {chosen.name}')}"
    values = {name: value for name, value in (whole | changes).items() if name in chosen.names}
    try:
        TypeAdapter(chosen.params).validate_python(values)
    except ValidationError as error:
        for problem in error.errors():
            yield f"{chosen.name}: {'.'.join(map(str, problem['loc']))}: {problem['msg']}, not {problem['input']!r}"


def _series(name: str, given: "ArrayLike") -> "Floats":
    import numpy as np

    try:
        values = np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise UsageError(f"update_batch: {name} is no series of numbers: {error}") from error
    if values.ndim != 1:
        raise UsageError(f"update_batch: {name} has the shape {values.shape}; expected (n,)")
    return values
