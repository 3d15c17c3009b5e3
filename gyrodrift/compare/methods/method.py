"""What a drift reducer is here: one record, so that another one joins by one entry in `registry.py`."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec

from gyrodrift.arrays import Floats
from gyrodrift.evaluation.reference import Beside
from gyrodrift.evaluation.space import Axis

Params = Mapping[str, float]
"""Values by name; the names carry the units, but for those that a package has given."""

Run = Callable[[Floats, Floats, Params], Floats]
"""From device times in s and measured rates in deg/s, shape (n,), to yaw in deg, shape (n,), 0 at the first sample."""


@dataclass(frozen=True, slots=True)
class Method:
    """A way to yaw.

    key, title
        Its name in files, and for people.
    run
        Walks through one session. It sees nothing but times and rates; see `seeing`.
    defaults
        What it runs with where nothing is tuned.
    axes
        What tuning may change, and where; none for methods that are not tuned.
    package
        What has to be installed for it; empty where nothing has.
    is_offline
        It sees a session's future: no device can do what it does.
    about
        Where the defaults come from, and what a package cannot do. A sentence or two.
    counts_samples
        Its tuned parameters belong to the sample rate they were found at.
    sigma
        The standard deviation that it states of its yaw, deg, shape (n,), from what `run` takes; None where it states
        none, and NaN likewise.
    seeing
        The method as it sees what is known beside the rate of a session; None for one that sees the rate alone.
    colour, dash
        How it is drawn: a role of the page's style sheet, and `-` or `--`.
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
    seeing: "Callable[[Beside], Method] | None" = None
    colour: str = "ink"
    dash: str = "-"

    @property
    def is_installed(self) -> bool:
        """Whether it can run here."""
        return not self.package or find_spec(self.package) is not None

    @property
    def version(self) -> str:
        """Of its package; empty where it has none, or it is not installed."""
        try:
            return version(self.package) if self.package else ""
        except PackageNotFoundError:
            return ""
