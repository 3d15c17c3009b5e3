"""A recording as frames of a device, for `replay`; the encoders of the simulator make the frames."""

from collections.abc import Iterable, Iterator

import numpy as np

from firmware_sim.rig import Base
from firmware_sim.wire.encoder import Frame, Measurement, Vector
from gyrodrift.session.mcap.raw import Read
from gyrodrift.session.session import Session
from gyrodrift.values.arrays import Floats
from gyrodrift.values.errors import DataError

ENCODER_CPR = 3_600_000
"""Counts per turn for the angles of a recording: steps of 0.0001 deg."""

LATEST_S = 1e12
"""30,000 years; no clock of a device shows more."""

MOST_MISSING = 1e9
"""Largest step of the counter; counters of devices wrap long before."""


class PlayedSession:
    """The samples of a session, once or forever; each pass continues the time of the previous one."""

    def __init__(self, session: Session, *, is_looping: bool) -> None:
        self.session = session = _timed_part(session)
        self._is_looping = is_looping
        steps_s = np.diff(session.t_device_s)
        self.period_s = float(np.median(steps_s[steps_s > 0])) if np.any(steps_s > 0) else 0.01
        # A device counts lost samples too: a gap in time is a gap in the counter.
        with np.errstate(over="ignore"):  # a step of years among tiny steps
            steps = np.clip(np.rint(steps_s / self.period_s), 1.0, MOST_MISSING)
        self._counter = np.concatenate([[0], np.cumsum(steps)]).astype(np.int64).tolist()

    def __iter__(self) -> Iterator[Measurement]:
        once_s = float(np.max(self.session.t_device_s) - self.session.t_device_s[0]) + self.period_s
        later_s, later_seq = 0.0, 0
        while True:
            yield from self._once(later_s, later_seq)
            if not self._is_looping:
                return
            later_s += once_s
            later_seq += self._counter[-1] + 1

    def _once(self, later_s: float, later_seq: int) -> Iterator[Measurement]:
        session = self.session
        count = len(session.t_device_s)
        missing: list[float | None] = [None] * count
        seqs = self._counter if session.seq is None else session.seq.tolist()
        angles = missing if session.encoder_deg is None else session.encoder_deg.tolist()
        temps = missing if session.temp_c is None else session.temp_c.tolist()
        stills = missing if session.still is None else session.still.tolist()
        axes = (_vectors(session.gyro_dps, count), _vectors(session.accel_mps2, count))
        first_s, due_s = float(session.t_device_s[0]), 0.0
        columns = (session.t_device_s.tolist(), seqs, session.rate_dps.tolist(), angles, temps, stills, *axes)
        for t_s, seq, *values in zip(*columns, strict=True):
            due_s = max(due_s, t_s - first_s)
            yield Measurement(later_s + due_s, round((t_s + later_s) * 1e6), seq + later_seq, *values)


def _vectors(array: Floats | None, count: int) -> Iterable[Vector | None]:
    return [None] * count if array is None else map(tuple, array.tolist())


def _timed_part(session: Session) -> Session:
    """The samples with a possible device time, because a protocol cannot carry an unknown time.

    Raises
    ------
    DataError
        No sample has one.
    """
    is_timed = np.abs(session.t_device_s) < LATEST_S
    if is_timed.all():
        return session
    if not is_timed.any():
        raise DataError(f"{session.name}: no sample has a possible device time")
    return session.rows(np.flatnonzero(is_timed))


def base_of(recording: PlayedSession, dps_per_lsb: float) -> Base:
    """Base values of a device that would have recorded this, in steps of `dps_per_lsb`, deg/s."""
    cpr = ENCODER_CPR if recording.session.encoder_deg is not None else 0
    rate_hz = min(65535.0, max(1.0, 1.0 / recording.period_s))
    return Base(sample_rate_hz=rate_hz, dps_per_lsb=dps_per_lsb, encoder_cpr=cpr)


def raw_frames(reads: Iterable[Read]) -> Iterator[Frame]:
    """Frames of the original bytes of a link, damage included."""
    first_s: float | None = None
    for t_host_s, content in reads:
        first_s = t_host_s if first_s is None else first_s
        yield Frame(t_host_s - first_s, content, 1)
