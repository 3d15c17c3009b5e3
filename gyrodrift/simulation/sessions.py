"""Sessions of the simulated rig, as the host would have recorded them, without waiting for real time."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from firmware_sim.measure import Block, Motion, measure
from firmware_sim.rig import Base, Rig
from gyrodrift.arrays import Floats
from gyrodrift.files import write_whole
from gyrodrift.progress import OnProgress, counted, ignore_progress
from gyrodrift.session.files import write_session
from gyrodrift.session.session import Session

RIG = "rig.yaml"
"""Name of the rig file beside the sessions simulated with it."""


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
        count = sample_count(self.rig, self.minutes)
        for block in measure(self.rig, self.profile, self.seed, self.number):
            is_inside = block.seq < count
            if not is_inside.all():
                if is_inside.any():
                    yield as_recorded(block.only(is_inside), self.rig.base, str(self.number))
                return
            yield as_recorded(block, self.rig.base, str(self.number))

    def whole(self) -> Session:
        """The session in one piece."""
        chunks = list(self.chunks())
        columns = zip(
            *((c.t_device_s, c.rate_dps, c.t_host_s, c.seq, c.encoder_deg, c.temp_c) for c in chunks), strict=True
        )
        joined: list[Any] = [None if parts[0] is None else np.concatenate(parts) for parts in columns]
        return Session(str(self.number), *joined)


def as_recorded(block: Block, base: Base, name: str) -> Session:
    """Measurements as the host decodes them; the wire has the scale as a 32-bit float."""
    rate_dps = block.rate_raw.astype(np.float64) * float(np.float32(base.dps_per_lsb))
    angle_deg = block.encoder_counts.astype(np.float64) * (360.0 / base.encoder_cpr) if base.encoder_cpr else None
    return Session(
        name=name,
        t_device_s=block.t_device_us / 1e6,
        rate_dps=rate_dps,
        t_host_s=np.round(block.t_host_s, 6),
        seq=block.seq,
        encoder_deg=angle_deg,
        temp_c=block.temp_centi_c / 100.0,
    )


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
    """Write one session, with everything that is needed to simulate it again."""
    rig, seed, number = rig_yaml(simulated.rig), str(simulated.seed), str(simulated.number)
    tables = {"simulation": {"rig": rig, "seed": seed, "session": number}}
    if device_id is not None:
        tables["device"] = {"device_id": device_id}
    samples = sample_count(simulated.rig, simulated.minutes)
    chunks = counted("samples", simulated.chunks(), samples, progress, lambda chunk: len(chunk.t_device_s))
    write_session(path, chunks, tables)


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
