"""Sessions of the simulated rig, as the host would have recorded them, without waiting for real time.

A session holds what a device sends. The truth is what no device knows: the orientation of the sensor at each sample. It
stands beside a session of three axes as numpy arrays in `NAME.truth.npz`.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from math import nan
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray

from firmware_sim.measure import ACCEL_MISSING, Block, Motion, TriaxialBlock, measure
from firmware_sim.own_filter import OwnFilter, own_filter_of
from firmware_sim.rig import Base, Rig
from firmware_sim.second_source import AidStream, aid_streams, until
from firmware_sim.triaxial import kinematics_of
from gyrodrift.io.files import whole_file, write_whole
from gyrodrift.io.progress import OnProgress, counted, ignore_progress
from gyrodrift.session.aids import RowAids
from gyrodrift.session.files import write_session
from gyrodrift.session.session import DEVICE_COLUMNS, Session
from gyrodrift.values.aid import Aid
from gyrodrift.values.arrays import Floats

RIG = "rig.yaml"
"""Name of the rig file beside the sessions simulated with it."""

SIMULATED = (
    "t_device_s",
    "rate_dps",
    "t_host_s",
    "seq",
    "encoder_deg",
    "temp_c",
    "gyro_dps",
    "accel_mps2",
    *DEVICE_COLUMNS,
)
"""Arrays of a simulated session."""

ENDING = ".truth.npz"

CHUNK_SAMPLES = 1 << 14
"""Samples that are computed together."""


@dataclass(frozen=True, slots=True)
class Simulation:
    """Everything that determines a simulated session, to the last byte."""

    rig: Rig
    profile: Motion
    seed: int
    number: int = 0
    minutes: float = 10.0

    def chunks(self) -> Iterator[Session]:
        """The session in pieces of a few thousand samples, so that memory does not grow with its length."""
        count, own_filter = sample_count(self.rig, self.minutes), own_filter_of(self.rig.base)
        streams = aid_streams(self.rig.aids, self.profile, self.seed, self.number)
        for block in measure(self.rig, self.profile, self.seed, self.number):
            is_inside = block.seq < count
            if not is_inside.all():
                if is_inside.any():
                    yield self._recorded(block.only(is_inside), own_filter, streams)
                return
            yield self._recorded(block, own_filter, streams)

    def _recorded(self, block: Block, own_filter: OwnFilter | None, streams: list[AidStream]) -> Session:
        """A block as a session, with second sources and the results of the filter in the device."""
        session = as_recorded(block, self.rig.base, str(self.number))
        if streams:
            session = replace(session, aids=_row_aids(block.seq / self.rig.base.sample_rate_hz, streams))
        if own_filter is None:
            return session
        results = np.array(list(own_filter.results(block)))
        return session.with_device_yaw(dict(zip(DEVICE_COLUMNS, results.T, strict=True)))

    def whole(self) -> Session:
        """The session in one piece."""
        chunks = list(self.chunks())
        columns: dict[str, Any] = {
            name: np.concatenate([getattr(chunk, name) for chunk in chunks])
            for name in SIMULATED
            if getattr(chunks[0], name) is not None
        }
        firsts = np.cumsum([0, *(len(chunk.rate_dps) for chunk in chunks)]).tolist()
        pairs = zip(firsts, chunks, strict=False)
        aids = tuple((first + row, aid) for first, chunk in pairs for row, aid in chunk.aids or ())
        return Session(str(self.number), **columns, aids=aids if self.rig.aids else None)


def _row_aids(t_s: Floats, streams: list[AidStream]) -> RowAids:
    """Measurements that arrive with the samples at times after power-on, s; each has the time of its sample."""
    values = until(streams, float(t_s[-1]))
    rows = np.searchsorted(t_s, [value.t_s for value in values]).tolist()
    return tuple(
        (
            row,
            Aid(
                it.aid.name,
                it.aid.name,
                it.value,
                sigma=it.aid.sigma or nan,
                period_deg=it.aid.period_deg,
                speed=it.speed,
            ),
        )
        for row, it in zip(rows, values, strict=True)
    )


def as_recorded(block: Block, base: Base, name: str) -> Session:
    """Measurements as the host decodes them; the wire has the scale as a 32-bit float."""
    rate_dps = block.rate_raw.astype(np.float64) * float(np.float32(base.dps_per_lsb))
    gyro_dps, accel_mps2 = _axes(block, base, rate_dps)
    angle_deg = block.encoder_counts.astype(np.float64) * (360.0 / base.encoder_cpr) if base.encoder_cpr else None
    return Session(
        name=name,
        t_device_s=block.t_device_us / 1e6,
        rate_dps=rate_dps,
        t_host_s=np.round(block.t_host_s, 6),
        seq=block.seq,
        encoder_deg=angle_deg,
        temp_c=block.temp_centi_c / 100.0,
        gyro_dps=gyro_dps,
        accel_mps2=accel_mps2,
    )


def _axes(block: Block, base: Base, rate_dps: Floats) -> tuple[Floats | None, Floats | None]:
    """Rates and accelerations of a device with three axes; NaN where an acceleration is missing or clipped."""
    if not isinstance(block, TriaxialBlock) or base.three_axes is None:
        return None, None
    xy_dps = block.gyro_xy_raw.astype(np.float64) * float(np.float32(base.dps_per_lsb))
    gyro_dps = np.column_stack([xy_dps, rate_dps])
    if not block.accel_raw.shape[1]:
        return gyro_dps, None
    accel_mps2 = block.accel_raw.astype(np.float64) * float(np.float32(base.three_axes.mps2_per_lsb))
    is_missing = (block.accel_raw == ACCEL_MISSING) | block.accel_clipped[:, None]
    return gyro_dps, np.where(is_missing, np.nan, accel_mps2)


def write_sessions(
    rig: Rig,
    profile: Motion,
    folder: Path,
    seed: int,
    sessions: int,
    minutes: float,
    ending: str = "mcap",
    progress: OnProgress = ignore_progress,
) -> Iterator[Path]:
    """Write the rig, `session-01`, `session-02` and so on, and yield the path of each written session."""
    folder.mkdir(parents=True, exist_ok=True)
    write_whole(folder / RIG, [rig_yaml(rig)])
    samples = sample_count(rig, minutes)

    def pass_on(what: str, done: int, _: int) -> None:
        progress(what, number * samples + done, sessions * samples)

    for number, path in enumerate(simulated_paths(folder, sessions, ending)):
        write_simulation(path, Simulation(rig, profile, seed, number, minutes), progress=pass_on)
        yield path


def simulated_paths(folder: Path, sessions: int, ending: str = "mcap") -> list[Path]:
    """Paths of the sessions of `write_sessions`."""
    return [folder / f"session-{number + 1:02d}.{ending}" for number in range(sessions)]


def write_simulation(
    path: Path, simulated: Simulation, device_id: str | None = None, progress: OnProgress = ignore_progress
) -> None:
    """Write one session, with everything that is needed to simulate it again; three axes have their truth beside it."""
    rig, seed, number = rig_yaml(simulated.rig), str(simulated.seed), str(simulated.number)
    tables = {"simulation": {"rig": rig, "seed": seed, "session": number}}
    if device_id is not None:
        tables["device"] = {"device_id": device_id}
    samples = sample_count(simulated.rig, simulated.minutes)
    chunks = counted("samples", simulated.chunks(), samples, progress, lambda chunk: len(chunk.t_device_s))
    if simulated.rig.base.three_axes is None:
        write_session(path, chunks, tables)
        return
    seqs: list[NDArray[np.int64]] = []
    write_session(path, _noted(chunks, seqs), tables)
    if seqs:
        write_truth(path, simulated.profile, np.concatenate(seqs), simulated.rig.base.sample_rate_hz)


def _noted(chunks: Iterable[Session], seqs: list[NDArray[np.int64]]) -> Iterator[Session]:
    """Pieces of a session, whose counters are appended to `seqs`."""
    for chunk in chunks:
        if chunk.seq is not None:
            seqs.append(chunk.seq)
        yield chunk


def sample_count(rig: Rig, minutes: float) -> int:
    """Number of samples that the device of a rig sends in some minutes."""
    return round(minutes * 60.0 * rig.base.sample_rate_hz)


def rig_yaml(rig: Rig) -> str:
    """The rig as text of a file for `simulate` and `firmware_sim`."""
    text: str = yaml.safe_dump(rig.model_dump(), sort_keys=False)
    return text


def euler_error_deg(session: Session) -> Floats:
    """Yaw error of rate times step against the encoder, deg, 0 at the first sample; shape (n,).

    The published set that this reproduces states errors of this integration.
    """
    assert session.encoder_deg is not None  # noqa: S101 - callers simulate rigs with an encoder
    steps_s = np.diff(session.t_device_s, prepend=session.t_device_s[0])
    error_deg: Floats = np.cumsum(session.rate_dps * steps_s) - (session.encoder_deg - session.encoder_deg[0])
    return error_deg


def truth_path(session: Path) -> Path:
    """Path of the truth of a session."""
    return session.with_suffix(ENDING)


def write_truth(session: Path, motion: Motion, seq: NDArray[np.int64], sample_rate_hz: float) -> None:
    """Write the truth at the samples of a session.

    The arrays: seq (n,), t_s (n,) since the beginning, s, and quaternion (n, 4), the rotation w, x, y, z from sensor
    to earth.
    """
    t_s = seq / sample_rate_hz
    parts = [
        kinematics_of(motion, t_s[first : first + CHUNK_SAMPLES]).quaternion
        for first in range(0, len(t_s), CHUNK_SAMPLES)
    ]
    with whole_file(truth_path(session)) as file:
        np.savez_compressed(file, seq=seq, t_s=t_s, quaternion=np.concatenate(parts).astype(np.float32))
