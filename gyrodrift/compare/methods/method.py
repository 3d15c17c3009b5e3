"""The record of a method; `registry.py` lists all methods."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec

from gyrodrift.arrays import Floats
from gyrodrift.evaluation.reference import Auxiliary
from gyrodrift.evaluation.space import Axis

Params = Mapping[str, float]
"""Values by name; a name has its unit, except names of other packages."""

Run = Callable[[Floats, Floats, Params], Floats]
"""From device times in s and measured rates in deg/s, shape (n,), to yaw in deg, shape (n,), 0 at the first sample."""


@dataclass(frozen=True, slots=True)
class Method:
    """A method that computes yaw.

    key, title
        Name in files, and name in reports.
    run
        Computes yaw from times and rates; see `with_auxiliary` for auxiliary data.
    defaults
        Default parameters.
    axes
        Search ranges for tuning; empty for a method without tuning.
    package
        Required package; empty without one.
    is_offline
        The method uses the whole session and cannot run in real time.
    about
        Source of the defaults and limits of the package, in one or two sentences.
    counts_samples
        The tuned parameters hold for one sample rate.
    sigma
        Computes the standard deviation of yaw, deg, shape (n,), from the arguments of `run`; None if the method has
        none.
    with_auxiliary
        Returns the method with the auxiliary data of a session; None for a method that uses only the rate.
    color, dash
        Line style: a color role of the style sheet, and `-` or `--`.
    """

    key: str
    title: str
    run: Run
    defaults: Params = field(default_factory=dict)
    axes: tuple[Axis, ...] = ()
    package: str = ""
    is_offline: bool = False
    about: str = ""
    counts_samples: bool = False
    sigma: Run | None = None
    with_auxiliary: "Callable[[Auxiliary], Method] | None" = None
    color: str = "ink"
    dash: str = "-"

    @property
    def is_installed(self) -> bool:
        """Whether the required package is installed."""
        return not self.package or find_spec(self.package) is not None

    @property
    def version(self) -> str:
        """Version of the package; empty without an installed package."""
        try:
            return version(self.package) if self.package else ""
        except PackageNotFoundError:
            return ""
