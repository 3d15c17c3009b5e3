"""A recording on an even grid of samples, the input of a diagnosis. Real and simulated sessions have the same form."""

from dataclasses import dataclass, replace

import numpy as np

from gyrodrift.diagnose.recording.numbering import number_samples
from gyrodrift.session.session import Session, unwrapped
from gyrodrift.values.arrays import Floats
from gyrodrift.values.constants import NORMAL_MAD
from gyrodrift.values.errors import DataError

MOST_DPS, MOST_DEG, MOST_S, MOST_MPS2 = 1e6, 1e9, 1e12, 1e6
"""Largest plausible rate, angle, time and acceleration. Chosen: the limits are wide, because the unit may be wrong and
a reference may have turned for years."""

SHORTEST_S, LONGEST_S = 1e-5, 1.0
"""Limits of the sample period, s. Derived: a rig has 1 to 65,535 Hz, and 1e-5 s is a little shorter."""

EVEN_STAMPS = 0.1
"""Largest standard deviation of a stamp, in sample periods, that still numbers the samples. Derived: a missing sample
shows from a step of 1.6 periods on: at 0.1, with sqrt(2) of it in a step, that is more than four standard deviations
away."""


@dataclass(frozen=True, slots=True)
class Recording:
    """Measurements on the grid. Arrays have the shape (n,) unless stated, and NaN where a sample is missing.

    period_s
        Sample period, s, by the host's clock; without a host's clock by that of the device.
    rate_dps, encoder_deg
        Measured rate, deg/s, and unwrapped angle from the encoder's own zero, degrees.
    device_s, host_s
        Device time and arrival time since the first sample, s. `host_s` is None without arrival times.
    temp_c
        Temperature, °C, or None.
    powered_s
        Device time of the first sample, s, at least 0.
    repeated, disordered
        Number of samples that came twice, and number of those that came after a later sample.
    has_counter
        Whether the session has a sample counter, which tells the missing samples.
    host_ahead_s
        Host's clock minus device clock in the first samples, s; None without a host's clock.
    gyro_xy_dps, accel_mps2
        Rates about x and y, deg/s, shape (n, 2), and specific force, m/s², shape (n, 3); None without three axes.
    """

    name: str
    period_s: float
    rate_dps: Floats
    encoder_deg: Floats
    device_s: Floats
    host_s: Floats | None
    temp_c: Floats | None
    powered_s: float
    repeated: int
    disordered: int
    has_counter: bool
    host_ahead_s: float | None = None
    gyro_xy_dps: Floats | None = None
    accel_mps2: Floats | None = None

    @property
    def has_motion(self) -> bool:
        """Whether the encoder turned by more than 5 degrees, which is more than it creeps at rest."""
        return bool(np.nanmax(self.encoder_deg) - np.nanmin(self.encoder_deg) > 5.0)

    @property
    def counts_samples(self) -> bool:
        """Whether missing samples are known: by a counter, or by stamps that scatter less than EVEN_STAMPS."""
        if self.has_counter:
            return True
        bends_s = np.abs(np.diff(self.device_s, 2))
        bends_s = bends_s[np.isfinite(bends_s)]
        scatter_s = float(np.median(bends_s)) * NORMAL_MAD / np.sqrt(6.0) if len(bends_s) else np.inf
        return bool(scatter_s < EVEN_STAMPS * self.period_s)

    def at_temperature(self, temp_c: float) -> "Recording":
        """The recording at a constant temperature, with NaN where a sample is missing."""
        return replace(self, temp_c=np.where(np.isfinite(self.device_s), temp_c, np.nan))

    @property
    def seconds(self) -> float:
        """Length, s."""
        return len(self.rate_dps) * self.period_s


def recording_of(session: Session, samples: int | None = None) -> Recording:
    """Put a session on its grid.

    samples
        Length of the grid: later samples are cut off, and missing ones are NaN. None takes the length of the session.

    Raises
    ------
    DataError
        If the session has no encoder, too few samples, or an implausible counter, time or value.
    """
    if session.encoder_deg is None:
        raise DataError(f"{session.name}: has no encoder, so its true motion is unknown")
    _check_values(session)
    numbers = number_samples(session)
    count = int(numbers.sample[-1]) + 1
    if count > 3 * len(numbers.sample):
        by = "time stamps" if session.seq is None else "counter"
        raise DataError(f"{session.name}: by its {by} it has {count} samples, but the file has {len(numbers.sample)}")
    length = count if samples is None else samples
    inside = numbers.sample < length
    index, row = numbers.sample[inside], numbers.row[inside]

    def on_grid(values: Floats | None) -> Floats | None:
        """Rows of a column on the grid; None if no value is finite."""
        if values is None or not np.isfinite(values).any():
            return None
        out = np.full((length, *values.shape[1:]), np.nan)
        out[index] = values[row]
        return out

    device_s, host_s = on_grid(session.t_device_s), on_grid(session.t_host_s)
    rate_dps, encoder_deg = on_grid(session.rate_dps), on_grid(session.encoder_deg)
    if device_s is None or rate_dps is None or encoder_deg is None:
        raise DataError(f"{session.name}: has no numbers in its times, rates or angles")
    clock_s = device_s if host_s is None else host_s
    for values in (device_s, clock_s):
        _check_period(session.name, fit_line(values)[0], values)
    return Recording(
        name=session.name,
        period_s=fit_line(clock_s)[0],
        rate_dps=rate_dps,
        encoder_deg=unwrapped(encoder_deg),
        device_s=device_s - session.t_device_s[0],
        host_s=None if host_s is None else host_s - host_s[np.isfinite(host_s)][0],
        temp_c=on_grid(session.temp_c),
        powered_s=max(0.0, float(session.t_device_s[0])),
        repeated=numbers.repeated,
        disordered=numbers.disordered,
        has_counter=session.seq is not None,
        host_ahead_s=_host_ahead_s(session),
        gyro_xy_dps=on_grid(None if session.gyro_dps is None else session.gyro_dps[:, :2]),
        accel_mps2=on_grid(session.accel_mps2),
    )


def _check_values(session: Session) -> None:
    """Check that all values are plausible.

    Raises
    ------
    DataError
        If a value is above its limit; the message states both.
    """
    for values, most, words in (
        (session.rate_dps, MOST_DPS, "a rate of {:g} deg/s"),
        (session.encoder_deg, MOST_DEG, "an angle of {:g} degrees"),
        (session.gyro_dps, MOST_DPS, "a rate of {:g} deg/s"),
        (session.accel_mps2, MOST_MPS2, "an acceleration of {:g} m/s²"),
        (session.t_device_s, MOST_S, "a device time of {:g} s"),
        (session.t_host_s, MOST_S, "a host time of {:g} s"),
    ):
        if values is None:
            continue
        sizes = np.abs(values[np.isfinite(values)])
        if len(sizes) and sizes.max() > most:
            raise DataError(f"{session.name}: has {words.format(sizes.max())}; the largest plausible value is {most:g}")


def _check_period(name: str, period_s: float, clock_s: Floats) -> None:
    """Check that the sample period is plausible, and that the clock resolves it.

    Raises
    ------
    DataError
        If the period is outside SHORTEST_S to LONGEST_S, or if neighboring floats at the clock's time differ by more
        than half a period.
    """
    if not SHORTEST_S <= period_s <= LONGEST_S:
        raise DataError(f"{name}: its samples are {period_s:.3g} s apart; expected {SHORTEST_S:g} to {LONGEST_S:g} s")
    if np.spacing(np.nanmax(np.abs(clock_s))) > period_s / 2.0:
        largest_s = np.nanmax(np.abs(clock_s))
        raise DataError(f"{name}: its clock reads {largest_s:g} s, too large to tell its samples apart")


def _host_ahead_s(session: Session) -> float | None:
    """Least difference of host and device clock in the first 100 samples, s: the sample with the least delay.

    The clocks drift little during 100 samples.
    """
    if session.t_host_s is None:
        return None
    ahead_s = (session.t_host_s - session.t_device_s)[:100]
    finite_s = ahead_s[np.isfinite(ahead_s)]
    return float(finite_s.min()) if len(finite_s) else None


def fit_line(values: Floats) -> tuple[float, float]:
    """Slope and offset of values over their index, by least squares; NaN are ignored.

    Both are NaN with fewer than two values.
    """
    is_known = np.isfinite(values)
    index = np.arange(len(values), dtype=np.float64)
    index, finite = (index, values) if is_known.all() else (index[is_known], values[is_known])
    if len(index) < 2:
        return float("nan"), float("nan")
    middle = float(index.mean())
    centered = index - middle
    slope = float(centered @ (finite - finite[0])) / float(centered @ centered)
    return slope, float(finite.mean()) - slope * middle


def filled(values: Floats) -> Floats:
    """Values with linear interpolation across NaN."""
    is_known = np.isfinite(values)
    if is_known.all():
        return values
    index = np.arange(len(values))
    out: Floats = np.interp(index, index[is_known], values[is_known])
    return out
