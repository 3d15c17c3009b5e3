"""The filters of the firmware by their names on the wire, run sample by sample.

They are the Python twins of the C header. A simulated device runs them on its own counts.
"""

from math import nan

from gyrodrift.filters.filter import Filter
from gyrodrift.filters.hdr_filter import HDR
from gyrodrift.filters.restlevel_filter import RESTLEVEL
from gyrodrift.filters.run import Axes, FilterRun
from gyrodrift.values.sample import Inertial

Vector = tuple[float, float, float]

FILTERS: dict[str, tuple[Filter, Axes]] = {
    "hdr": (HDR, "1"),
    "restlevel": (RESTLEVEL, "1"),
    "attitude": (RESTLEVEL, "3"),
}
"""Filter and its axes by the name on the wire: attitude is restlevel on three axes."""


class RunningFilter:
    """One of the filters at its defaults, with its state."""

    def __init__(self, name: str) -> None:
        chosen, axes = FILTERS[name]
        self._run = FilterRun(chosen, chosen.params(), axes)
        self._has_axes = axes == "3"

    def step(self, t_s: float, gyro_dps: Vector, accel_mps2: Vector, temp_c: float = nan) -> tuple[float, float, float]:
        """Take a sample; yaw and its sigma in deg, and drift in deg/s. A rejected sample changes nothing."""
        inertial = Inertial(*gyro_dps, *accel_mps2) if self._has_axes else None
        self._run.step(t_s, gyro_dps[2], inertial, nan, temp_c)
        state = self._run.state
        return state.yaw_deg, state.yaw_sigma_deg, state.bias_dps


def device_filter(name: str) -> RunningFilter:
    """A filter by its name on the wire, before its first sample."""
    return RunningFilter(name)
