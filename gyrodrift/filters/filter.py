"""The record of a filter for configs, services, tunings and comparisons.

This file imports no numpy and no compiled code: `serve` and `record` use it too.
"""

from collections.abc import Callable
from dataclasses import Field, dataclass, fields
from math import nan
from typing import Any, ClassVar, Protocol

from gyrodrift.filters.aids.reading import AidedFilter


class FilterState(Protocol):
    """State of every filter after a sample.

    yaw_deg, yaw_sigma_deg
        Yaw and its standard deviation, deg; NaN for a filter without uncertainty.
    bias_dps, bias_sigma_dps
        Bias estimate and its standard deviation, deg/s; likewise.
    rest_probability, confidence
        Probability of rest, and of the most probable hypothesis; NaN likewise.
    samples, rejected
        Numbers of accepted and of rejected samples.
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
    def bias_sigma_dps(self) -> float:  # noqa: D102
        ...

    @property
    def rest_probability(self) -> float:  # noqa: D102
        ...

    @property
    def confidence(self) -> float:  # noqa: D102
        ...


class WitnessState(Protocol):
    """State of an external rest sensor in a filter, as `state.witness`.

    is_believed
        False from a contradiction by the rate until the sensor reports another state.
    refuted
        Number of contradictions.
    """

    is_believed: bool
    refuted: int


class FilterParams(Protocol):
    """A frozen dataclass of floats, each with a default and with its bounds as `Annotated[float, Ge(0.0), Le(1.0)]`."""

    __dataclass_fields__: ClassVar[dict[str, Field[Any]]]


@dataclass(frozen=True, slots=True)
class SearchRange:
    """Search range of a parameter in its own unit, linear or logarithmic."""

    low: float
    high: float
    is_log: bool = False


@dataclass(frozen=True, slots=True)
class FilterParameter:
    """Meaning and search range of a parameter; `params` of the filter has its bounds and default.

    line
        Meaning in a line, for the config.
    effect
        Effects of small and large values, for the report.
    decided_by
        Sessions that identify the parameter: `it needs ...`.
    search
        None for a parameter without influence on yaw.
    """

    name: str
    unit: str
    line: str
    effect: str
    decided_by: str
    search: SearchRange | None = None


@dataclass(frozen=True, slots=True)
class ReducedModel:
    """A filter with only these parameters tuned, for comparison with the full model, and its name."""

    names: tuple[str, ...]
    title: str


def as_they_are(params: Any) -> Any:
    """Coefficients of a filter whose step uses its parameters directly."""
    return params


def keep_state(_state: Any) -> None:
    """Leave the state of a filter without a yaw sigma as it is."""


def keep_params(params: Any, _scale_sigma: float) -> Any:
    """Parameters of a filter that does not model the scale factor."""
    return params


def unknown_sigma(_coefficients: Any, _state: Any) -> float:
    """Scale share of the yaw sigma of a filter that has none: NaN."""
    return nan


def one_axis(_knowledge: Any) -> int:
    """Number of axes of a filter without a version for three."""
    return 1


@dataclass(frozen=True, slots=True)
class FilterMemory:
    """Functions that keep knowledge of a sensor between runs, as a frozen dataclass of the filter.

    learned
        From the state, the earlier knowledge and its age in s to the new knowledge; None without any.
    begun
        From parameters, knowledge, its age in s and the temperature in °C (None if unknown) to an initial state.
    read
        From a table of a file to the knowledge; ValueError for a wrong table.
    axes
        Number of axes of some knowledge.
    """

    learned: Callable[[Any, Any, float], Any]
    begun: Callable[[Any, Any, float, float | None], Any]
    read: Callable[[Any], Any]
    axes: Callable[[Any], int] = one_axis


@dataclass(frozen=True, slots=True)
class Filter:
    """A filter: three records, a step, and its description for config, `serve`, `filter`, `tune` and `compare`.

    name
        Value of `filter:` in a config, and key of its block.
    params, coefficients, state
        Record of the parameters; function from parameters to coefficients; constructor of a new state.
    step
        Takes coefficients, state, device time in s and rate in deg/s; False if the sample is rejected.
    uses_auxiliary
        The step takes two more numbers: rest by an external sensor (1 rest, 0 motion) and the temperature in °C, both
        NaN if unknown. The state then has a `witness`, a `WitnessState`.
    memory
        Functions that keep knowledge of the sensor; None for a filter without memory.
    zero
        From the present sample on `yaw_sigma_deg` is that of the yaw turned since; yaw itself does not jump.
    with_scale_sigma
        Parameters for a device whose scale factor has this standard deviation, as a share, from a calibration.
    scale_sigma_deg
        Share of `yaw_sigma_deg` that comes from the scale factor, deg; NaN for a filter without a yaw sigma.
    aided
        Functions that take measurements of second sources; None for a filter that cannot.
    columns
        Attributes of the state that `gyrodrift filter` writes after time and rate.
    parameters : tuple of FilterParameter
        Meaning of each parameter, in the order of `params`.
    baseline
        Parameters of plain integration.
    unsearched
        Values of parameters outside the search; None for the defaults.
    reduced
        Reduced model; None for the first searched parameter alone.
    sample_counted
        Names of the parameters that count samples and hold for one sample rate; empty without such parameters.
    kernel
        `module:NAME` of the compiled `gyrodrift.evaluation.kernels.kernel.Kernel`; empty for plain stepping, which is
        slow.
    title, about
        Name for people, and source of the defaults.
    color, dash
        Line style: a role of the style sheet of the pages, and `-` or `--`.
    """

    name: str
    params: type[Any]
    state: Callable[[], Any]
    step: Callable[..., bool]
    columns: tuple[str, ...]
    parameters: tuple[FilterParameter, ...]
    baseline: FilterParams
    coefficients: Callable[[Any], Any] = as_they_are
    unsearched: FilterParams | None = None
    reduced: ReducedModel | None = None
    sample_counted: str = ""
    kernel: str = ""
    title: str = ""
    about: str = "Defaults, or the parameters of --config."
    color: str = "ink"
    dash: str = "--"
    uses_auxiliary: bool = False
    memory: FilterMemory | None = None
    aided: AidedFilter | None = None
    zero: Callable[[Any], None] = keep_state
    with_scale_sigma: Callable[[Any, float], Any] = keep_params
    scale_sigma_deg: Callable[[Any, Any], float] = unknown_sigma

    def scaled(self, params: Any, sigma: float | None) -> Any:
        """Parameters for a device whose scale factor has this standard deviation; unchanged for None."""
        return params if sigma is None else self.with_scale_sigma(params, sigma)

    @property
    def step_auxiliary(self) -> Callable[[Any, Any, float, float, float, float], bool]:
        """The step with auxiliary arguments, which a filter of the rate alone ignores."""
        if self.uses_auxiliary:
            return self.step
        step = self.step
        return lambda c, s, t_s, rate_dps, _still, _temp_c: step(c, s, t_s, rate_dps)

    @property
    def counts_samples(self) -> bool:
        """Whether some parameters hold for one sample rate only."""
        return bool(self.sample_counted)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters, in the order of the columns of a candidate."""
        return tuple(field.name for field in fields(self.params))

    @property
    def searched(self) -> tuple[FilterParameter, ...]:
        """The parameters that a search may change."""
        return tuple(parameter for parameter in self.parameters if parameter.search is not None)

    @property
    def reduced_model(self) -> ReducedModel:
        """Reduced model, by default the first searched parameter alone."""
        return self.reduced or ReducedModel((self.searched[0].name,), f"{self.searched[0].name} alone")

    @property
    def rate_note(self) -> str:
        """Note on parameters and sample rate, for the head of a config."""
        if self.counts_samples:
            return f"{self.sample_counted} count samples: the values hold for sample_rate_hz."
        return "No parameter counts samples: the values hold at any sample rate of this sensor."

    def parameter(self, name: str) -> FilterParameter:
        """Meaning of a parameter.

        Raises
        ------
        KeyError
            If the filter has no such parameter.
        """
        return {parameter.name: parameter for parameter in self.parameters}[name]
