"""What a filter is to everything that configures, runs, tunes and compares filters: one record.

No numpy here and nothing compiled: `serve` and `record` read these records too.
"""

from collections.abc import Callable
from dataclasses import Field, dataclass, fields
from math import nan
from typing import Any, ClassVar, Protocol


class FilterState(Protocol):
    """What every filter tells after a sample.

    yaw_deg, yaw_sigma_deg
        Yaw and its standard deviation, deg; NaN for a filter that does not know how certain it is.
    bias_dps, bias_sigma_dps
        The drift estimate and its standard deviation, deg/s; likewise.
    rest_probability, confidence
        Probability that the device is at rest, and of what the filter believes has happened; NaN likewise.
    samples, rejected
        Samples accepted and passed by.
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
    """What a filter that hears a witness of rest tells of it, as `state.witness`.

    is_believed
        Until the rate has contradicted it, and again once it has said something else.
    refuted
        How often it was found out.
    """

    is_believed: bool
    refuted: int


class FilterParams(Protocol):
    """A frozen dataclass of floats, each with a default and with its bounds as `Annotated[float, Ge(0.0), Le(1.0)]`."""

    __dataclass_fields__: ClassVar[dict[str, Field[Any]]]


@dataclass(frozen=True, slots=True)
class SearchRange:
    """Where a parameter is searched, in its own unit, and whether factors or differences count there."""

    low: float
    high: float
    is_log: bool = False


@dataclass(frozen=True, slots=True)
class FilterParameter:
    """What a parameter means to a person, and where it is searched; bounds and default stand in the filter's `params`.

    line
        One line for the config.
    effect
        What small and large values do; a few sentences for the report.
    decided_by
        What sessions have to hold for the parameter to be identifiable: `it takes ...`.
    search
        None for a parameter that yaw does not depend on.
    """

    name: str
    unit: str
    line: str
    effect: str
    decided_by: str
    search: SearchRange | None = None


@dataclass(frozen=True, slots=True)
class ReducedModel:
    """The filter with only these parameters tuned, which the whole is held against, and what it is called."""

    names: tuple[str, ...]
    title: str


def as_they_are(params: Any) -> Any:
    """The coefficients of a filter that steps on its parameters alone."""
    return params


def keep_state(_state: Any) -> None:
    """Leave the state of a filter without a yaw sigma as it is."""


def keep_params(params: Any, _scale_sigma: float) -> Any:
    """Parameters of a filter that does not model the scale factor."""
    return params


def unknown_sigma(_coefficients: Any, _state: Any) -> float:
    """Scale share of the yaw sigma of a filter that has none: NaN."""
    return nan


@dataclass(frozen=True, slots=True)
class FilterMemory:
    """How a filter remembers its sensor from one run to the next, as a frozen dataclass of its own.

    learned
        From the state, what was remembered before and how old that is now, s, to what is known; None for nothing yet.
    begun
        From parameters, what is remembered, its age in s and the temperature of the sensor in °C, None where that is
        not known, to a new state.
    read
        What is remembered, from a table of a file; ValueError where it is none.
    """

    learned: Callable[[Any, Any, float], Any]
    begun: Callable[[Any, Any, float, float | None], Any]
    read: Callable[[Any], Any]


@dataclass(frozen=True, slots=True)
class Filter:
    """A filter: three records, a step, and what config, `serve`, `filter`, `tune` and `compare` ask about it.

    name
        As the config calls it: the value of `filter:`, and the key of its block.
    params, coefficients, state
        The record of parameters; from parameters to what is worked out once; an empty state.
    step
        Takes coefficients, state, device time in s and rate in deg/s; False where the sample was passed by.
    sees_beside
        Whether its step takes two more numbers, what is known beside the rate: 1 where something else says that the
        device stands still and 0 where it moves, and the temperature of the sensor in °C; NaN where nobody says. Its
        state then has a `witness`, a `WitnessState`.
    memory
        How it remembers its sensor; None for one that begins anew.
    zero
        From the present sample on `yaw_sigma_deg` is that of the yaw turned since; yaw itself does not jump.
    with_scale_sigma
        Parameters for a device whose scale factor has this standard deviation, as a share, from a calibration.
    scale_sigma_deg
        Share of `yaw_sigma_deg` that comes from the scale factor, deg; NaN for a filter without a yaw sigma.
    columns
        Attributes of the state that `gyrodrift filter` writes beside time and rate.

    Parameters
    ----------
        What is known of each parameter, in the order of `params`.
    baseline
        Parameters with which it learns and filters nothing: plain integration.
    unsearched
        What parameters are while they are not searched; None for the defaults.
    reduced
        None for the first parameter that is searched.
    sample_counted
        Which parameters count samples, and so belong to the sample rate they were found at; empty where none does.
    kernel
        `module:NAME` of its compiled `gyrodrift.evaluation.kernels.kernel.Kernel`, imported by who evaluates
        candidates; empty for plain stepping, which is slow and right.
    title, about
        For people; where the defaults come from.
    colour, dash
        How it is drawn among others: a role of the page's style sheet, and `-` or `--`.
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
    about: str = "Its defaults where no --config is given."
    colour: str = "ink"
    dash: str = "--"
    sees_beside: bool = False
    memory: FilterMemory | None = None
    zero: Callable[[Any], None] = keep_state
    with_scale_sigma: Callable[[Any, float], Any] = keep_params
    scale_sigma_deg: Callable[[Any, Any], float] = unknown_sigma

    @property
    def step_beside(self) -> Callable[[Any, Any, float, float, float, float], bool]:
        """The step with what is known beside the rate, which a filter of the rate alone passes by."""
        if self.sees_beside:
            return self.step
        step = self.step
        return lambda c, s, t_s, rate_dps, _still, _temp_c: step(c, s, t_s, rate_dps)

    @property
    def counts_samples(self) -> bool:
        """Whether its parameters belong to the sample rate they were found at."""
        return bool(self.sample_counted)

    @property
    def names(self) -> tuple[str, ...]:
        """Of the parameters, in the order of a candidate's columns."""
        return tuple(each.name for each in fields(self.params))

    @property
    def searched(self) -> tuple[FilterParameter, ...]:
        """The parameters that a search may change."""
        return tuple(one for one in self.parameters if one.search is not None)

    @property
    def reduced_model(self) -> ReducedModel:
        """The one that is given, or that of the first parameter."""
        return self.reduced or ReducedModel((self.searched[0].name,), f"{self.searched[0].name} alone")

    @property
    def rate_note(self) -> str:
        """What its parameters have to do with the sample rate, for the head of a config."""
        if self.counts_samples:
            return f"{self.sample_counted} count samples: the numbers belong to sample_rate_hz."
        return "Nothing in them counts samples: they hold at any rate of this sensor."

    def parameter(self, name: str) -> FilterParameter:
        """What is known of a parameter.

        Raises
        ------
        KeyError
            Where it has none of that name.
        """
        return {one.name: one for one in self.parameters}[name]
