"""A recording on an even grid of samples: what diagnose looks at, real and simulated alike."""

from dataclasses import dataclass

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.recording.numbering import numbered
from gyrodrift.errors import DataError
from gyrodrift.session.angles import unwrapped
from gyrodrift.session.session import Session

MOST_DPS, MOST_DEG, MOST_S, MOST_MPS2 = 1e6, 1e9, 1e12, 1e6
"""Rates in any unit that a gyro was ever read in, a reference that turned for years, clocks and forces in any unit."""

SHORTEST_S, LONGEST_S = 1e-5, 1.0
"""Between two samples: what a rig may be asked to play, and a little more."""


@dataclass(frozen=True, slots=True)
class Recording:
    """Measurements by number; arrays have the shape (n,) unless stated, with NaN where the sample is missing.

    period_s
        True distance of two samples: by the host's clock where there is one, by the device's elsewhere.
    rate_dps, encoder_deg
        As measured, deg/s and degrees from the encoder's own zero.
    device_s, host_s, temp_c
        Stamp and arrival less the first of each, s, and temperature, °C; None where there is none.
    powered_s
        What the device clock said at the first sample, s.
    repeated, disordered
        How many samples came twice, or after a later one.
    has_counter
        Whether samples that are missing are known from a counter.
    host_ahead_s
        What the host's clock said more than the device's at first, s; None without a host's clock.
    gyro_xy_dps, accel_mps2
        Rates about x and y, deg/s, shape (n, 2), and specific force, m/s², shape (n, 3), of a sensor with three axes;
        None without them.
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
    def moves(self) -> bool:
        """Whether the encoder turned by more than it may creep at rest."""
        # More than an encoder creeps at rest.
        return bool(np.nanmax(self.encoder_deg) - np.nanmin(self.encoder_deg) > 5.0)

    @property
    def seconds(self) -> float:
        """Length, s."""
        return len(self.rate_dps) * self.period_s


def recording_of(session: Session, samples: int | None = None) -> Recording:
    """Put a session on its grid; `samples` cuts or fills it to a length.

    Raises
    ------
    DataError
        Where it has no encoder, too few samples, or a counter, times or values that make no sense.
    """
    if session.encoder_deg is None:
        raise DataError(f"{session.name}: has no encoder, so nothing says how it really moved")
    _check_values(session)
    found = numbered(session)
    count = int(found.number[-1]) + 1
    if count > 3 * len(found.number):
        raise DataError(f"{session.name}: its counter speaks of {count} samples, and {len(found.number)} are there")
    length = count if samples is None else samples
    inside = found.number < length
    place, taken = found.number[inside], found.place[inside]

    def spread(values: Floats | None) -> Floats | None:
        if values is None or not np.isfinite(values).any():
            return None
        out = np.full((length, *values.shape[1:]), np.nan)
        out[place] = values[taken]
        return out

    device_s, host_s = spread(session.t_device_s), spread(session.t_host_s)
    rate_dps, encoder_deg = spread(session.rate_dps), spread(session.encoder_deg)
    if device_s is None or rate_dps is None or encoder_deg is None:
        raise DataError(f"{session.name}: holds no numbers in its times, rates or angles")
    clock_s = device_s if host_s is None else host_s
    for values in (device_s, clock_s):
        _check_period(session.name, line(values)[0], values)
    return Recording(
        name=session.name,
        period_s=line(clock_s)[0],
        rate_dps=rate_dps,
        encoder_deg=unwrapped(encoder_deg),
        device_s=device_s - session.t_device_s[0],
        host_s=None if host_s is None else host_s - host_s[np.isfinite(host_s)][0],
        temp_c=spread(session.temp_c),
        powered_s=max(0.0, float(session.t_device_s[0])),
        repeated=found.repeated,
        disordered=found.disordered,
        has_counter=session.seq is not None,
        host_ahead_s=_host_ahead_s(session),
        gyro_xy_dps=spread(None if session.gyro_dps is None else session.gyro_dps[:, :2]),
        accel_mps2=spread(session.accel_mps2),
    )


def _check_values(session: Session) -> None:
    """See that nothing in it is beyond what a sensor says and a calculation holds.

    Raises
    ------
    DataError
        With what is.
    """
    for values, most, what in (
        (session.rate_dps, MOST_DPS, "a rate of {:g} deg/s"),
        (session.encoder_deg, MOST_DEG, "an angle of {:g} degrees"),
        (session.gyro_dps, MOST_DPS, "a rate of {:g} deg/s"),
        (session.accel_mps2, MOST_MPS2, "an acceleration of {:g} m/s²"),
        (session.t_device_s, MOST_S, "a device time of {:g} s"),
        (session.t_host_s, MOST_S, "a host time of {:g} s"),
    ):
        if values is None:
            continue
        known = np.abs(values[np.isfinite(values)])
        if len(known) and known.max() > most:
            raise DataError(f"{session.name}: holds {what.format(known.max())}; no more than {most:g} is believed")


def _check_period(name: str, period_s: float, clock_s: Floats) -> None:
    """See that a clock goes forward, at a pace that a gyro has, and in steps that are finer than its samples.

    Raises
    ------
    DataError
        Where it does not.
    """
    if not SHORTEST_S <= period_s <= LONGEST_S:
        raise DataError(f"{name}: its samples are {period_s:.3g} s apart; expected {SHORTEST_S:g} to {LONGEST_S:g} s")
    if np.spacing(np.nanmax(np.abs(clock_s))) > period_s / 2.0:
        raise DataError(f"{name}: its clock stands at {np.nanmax(np.abs(clock_s)):g} s, with no digits for its samples")


def _host_ahead_s(session: Session) -> float | None:
    """The least of the first samples: what comes late came later than it had to."""
    if session.t_host_s is None:
        return None
    ahead_s = (session.t_host_s - session.t_device_s)[:100]  # a clock that drifts has not gone far in 100 samples
    known = ahead_s[np.isfinite(ahead_s)]
    return float(known.min()) if len(known) else None


def line(values: Floats) -> tuple[float, float]:
    """Slope and offset of values over their places, by least squares; NaN are passed over."""
    is_known = np.isfinite(values)
    place = np.arange(len(values), dtype=np.float64)
    place, known = (place, values) if is_known.all() else (place[is_known], values[is_known])
    if len(place) < 2:
        return float("nan"), float("nan")
    middle = float(place.mean())
    away = place - middle
    slope = float(away @ (known - known[0])) / float(away @ away)
    return slope, float(known.mean()) - slope * middle


def filled(values: Floats) -> Floats:
    """Without holes: straight lines across them."""
    known = np.isfinite(values)
    if known.all():
        return values
    place = np.arange(len(values))
    out: Floats = np.interp(place, place[known], values[known])
    return out
