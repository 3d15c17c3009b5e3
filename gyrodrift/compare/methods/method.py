"""The record of a method; `registry.py` lists all methods."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec

from gyrodrift.evaluation.auxiliary import Auxiliary, DeviceColumns, InertialColumns
from gyrodrift.evaluation.space import Axis
from gyrodrift.session.aids import RowAids
from gyrodrift.values.arrays import Floats

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
    with_axes
        Returns the method with the three axes of a session and its auxiliary data; None for a method that runs on the
        rate of the heading.
    needs_axes
        The method runs only if all sessions have accelerations.
    with_device_yaw
        Returns the method with the yaw of the device's own filter; None for a method that computes yaw itself.
    needs_device_yaw
        The method runs only if all sessions have the yaw of the device's own filter.
    with_aids
        Returns the method with the three axes, auxiliary data and second sources of a session; None for the others.
    needs_aids
        The method runs only if a session has second sources.
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
    with_axes: "Callable[[InertialColumns, Auxiliary], Method] | None" = None
    needs_axes: bool = False
    with_device_yaw: "Callable[[DeviceColumns], Method] | None" = None
    needs_device_yaw: bool = False
    with_aids: "Callable[[InertialColumns | None, Auxiliary, RowAids], Method] | None" = None
    needs_aids: bool = False
    color: str = "ink"
    dash: str = "-"

    def on(
        self,
        axes: InertialColumns | None,
        auxiliary: Auxiliary,
        device_yaw: DeviceColumns | None = None,
        aids: RowAids | None = None,
    ) -> "Method":
        """The method for the data of a session."""
        if self.with_aids is not None:
            return self.with_aids(axes, auxiliary, aids or ())
        if device_yaw is not None and self.with_device_yaw is not None:
            return self.with_device_yaw(device_yaw)
        if axes is not None and self.with_axes is not None:
            return self.with_axes(axes, auxiliary)
        return self.with_auxiliary(auxiliary) if self.with_auxiliary is not None else self

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
