"""The attitude filter as an object: heading and tilt from three rates and accelerations."""

from math import nan
from typing import TYPE_CHECKING, Any, NamedTuple

from gyrodrift.filters.filter import FilterParams
from gyrodrift.filters.restlevel_filter import RESTLEVEL
from gyrodrift.filters.run import FilterRun
from gyrodrift.io.result_table import ResultTable
from gyrodrift.library.filters import checked_params
from gyrodrift.library.second_sources import SecondSources
from gyrodrift.values.errors import UsageError
from gyrodrift.values.mount import Axis, Mount
from gyrodrift.values.sample import Inertial

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike

    from gyrodrift.values.arrays import Floats

MISSING = (nan, nan, nan)


class AttitudeEstimate(NamedTuple):
    """State of the attitude filter after a sample.

    yaw_deg, yaw_sigma_deg
        Heading, unwrapped, counter-clockwise positive, 0 at the first sample, and its standard deviation, deg.
    q_w, q_x, q_y, q_z
        Attitude as a quaternion from the sensor to the earth frame with z up; its heading is `yaw_deg`.
    tilt_deg, tilt_sigma_deg
        Angle between the up axis and the vertical, and its standard deviation, deg.
    roll_deg, pitch_deg
        Of the device; positive with the right side down, and with the nose down.
    bias_x_dps, bias_y_dps, bias_z_dps
        Bias of the rates, deg/s.
    rest_probability, confidence
        Probability that the device is at rest, and of the most probable hypothesis.
    is_accepted
        False if the sample was rejected: its time does not increase, or a rate is not finite.
    correction_deg
        Step of yaw in this sample that is no motion, deg: a change of the estimate. 0 else.
    """

    yaw_deg: float
    yaw_sigma_deg: float
    q_w: float
    q_x: float
    q_y: float
    q_z: float
    tilt_deg: float
    roll_deg: float
    pitch_deg: float
    tilt_sigma_deg: float
    bias_x_dps: float
    bias_y_dps: float
    bias_z_dps: float
    rest_probability: float
    confidence: float
    is_accepted: bool
    correction_deg: float = 0.0


class AttitudeEstimates(ResultTable):
    """Table with the fields of `AttitudeEstimate` as columns of shape (n,), a row for each sample."""

    def __init__(self, table: "Floats") -> None:
        self._columns: dict[str, Any] = dict(zip(AttitudeEstimate._fields, table, strict=True))
        self._columns["is_accepted"] = self._columns["is_accepted"] == 1.0

    def __getattr__(self, name: str) -> "Floats":
        """A column."""
        if name.startswith("_") or name not in self._columns:
            raise AttributeError(f"AttitudeEstimates has no column {name}")
        column: Floats = self._columns[name]
        return column

    def columns(self) -> dict[str, Any]:
        """The columns by name."""
        return dict(self._columns)


class AttitudeFilter(SecondSources):
    """Heading and tilt of a device that does not stay level, from three rates and accelerations.

    Parameters
    ----------
    params : RestlevelParams, optional
        Parameters of restlevel, as `tune` and a config give them.
    up, forward
        Axes of the sensor that point up and forward on the level device, for tilt, roll and pitch.
    changes
        Single parameters of restlevel by name.

    Raises
    ------
    UsageError
        If a parameter does not exist or is out of its bounds, or the mount is impossible.

    Examples
    --------
    >>> attitude = AttitudeFilter()
    >>> estimate = attitude.update_at(gyro_dps=(0.1, 0.0, 0.2), accel_mps2=(0.0, 0.0, 9.81), t_s=0.0)
    """

    def __init__(
        self, params: FilterParams | None = None, *, up: Axis = "+z", forward: Axis = "+x", **changes: float
    ) -> None:
        try:
            self.mount = Mount(up, forward)
        except ValueError as error:
            raise UsageError(f"AttitudeFilter: {error}") from error
        self.params = checked_params(RESTLEVEL, params, changes)
        self.reset()

    def reset(self) -> None:
        """Reset the state: yaw is 0 at the next sample, and the biases are unknown."""
        self._run = FilterRun(RESTLEVEL, self.params, "3", self.mount)

    @property
    def corrections(self) -> int:
        """Number of corrections of yaw over 1 deg so far."""
        return self._run.corrections

    def gap(self) -> None:
        """Hold the attitude over the next step, as `Restlevel.gap` holds yaw."""
        self._run.gap()

    def restarted(self) -> None:
        """Hold the attitude and forget the biases, as `Restlevel.restarted` does."""
        self._run.gap(has_restarted=True)

    def update_at(
        self, gyro_dps: "Sequence[float]", accel_mps2: "Sequence[float]" = MISSING, *, t_s: float, temp_c: float = nan
    ) -> AttitudeEstimate:
        """Take a sample: rates in deg/s, accelerations in m/s² (NaN if missing) and its device time in s.

        `temp_c` is the temperature of the sensor in °C, which the biases follow. The sensor frame is right-handed; a
        sensor that lies flat measures +9.81 m/s² on z.
        """
        gx, gy, gz = map(float, gyro_dps)
        ax, ay, az = map(float, accel_mps2)
        is_accepted = self._run.step(float(t_s), gz, Inertial(gx, gy, gz, ax, ay, az), temp_c=float(temp_c))
        s, attitude = self._run.state, self._run.attitude()
        correction_deg = self._run.correction_deg if is_accepted else 0.0
        certainty = (s.rest_probability, s.confidence, is_accepted, correction_deg)
        return AttitudeEstimate._make((s.yaw_deg, s.yaw_sigma_deg, *attitude, *certainty))

    def update_batch(
        self, gyro_dps: "ArrayLike", accel_mps2: "ArrayLike", t_s: "ArrayLike", temp_c: "ArrayLike | None" = None
    ) -> AttitudeEstimates:
        """Take many samples, as `update_at` would one by one.

        Parameters
        ----------
        gyro_dps, accel_mps2
            Rates in deg/s and accelerations in m/s², shape (n, 3).
        t_s
            Times on the device clock, s, shape (n,).
        temp_c
            Temperatures of the sensor, °C, shape (n,); None if they are unknown.

        Raises
        ------
        UsageError
            If the arrays are not numbers of these shapes.
        """
        import numpy as np

        times = _table("t_s", t_s, ())
        rates, forces = _table("gyro_dps", gyro_dps, (3,)), _table("accel_mps2", accel_mps2, (3,))
        if not len(times) == len(rates) == len(forces):
            raise UsageError(f"update_batch: {len(times)} times, {len(rates)} rates and {len(forces)} accelerations")
        temps = np.full(len(times), nan) if temp_c is None else _table("temp_c", temp_c, ())
        if len(temps) != len(times):
            raise UsageError(f"update_batch: {len(times)} times and {len(temps)} temperatures")
        table = np.empty((len(AttitudeEstimate._fields), len(times)))
        columns = (rates.tolist(), forces.tolist(), times.tolist(), temps.tolist())
        for row, (rate, force, time, warm_c) in enumerate(zip(*columns, strict=True)):
            table[:, row] = self.update_at(rate, force, t_s=time, temp_c=warm_c)
        return AttitudeEstimates(table)


def _table(name: str, given: "ArrayLike", shape: tuple[int, ...]) -> "Floats":
    import numpy as np

    try:
        values = np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise UsageError(f"update_batch: {name} is no array of numbers: {error}") from error
    if values.ndim != len(shape) + 1 or values.shape[1:] != shape:
        expected = ", ".join(["n", *map(str, shape)]) + ("" if shape else ",")
        raise UsageError(f"update_batch: {name} has the shape {values.shape}; expected ({expected})")
    return values
