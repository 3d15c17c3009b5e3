"""A case as files: `sessions/` with CSV files and `rig.yaml`, nothing that says what is in them."""

from dataclasses import dataclass
from math import ceil, log10
from pathlib import Path

from gyrogap.physics.bench import Columns, measure
from gyrogap.physics.device import DrawnDevice
from gyrogap.physics.dice import Path as DicePath
from gyrogap.physics.driven import Mover
from gyrogap.physics.kinds import InjectedEffect
from gyrogap.physics.scene import scene_of
from gyrogap.physics.sessions import SessionPlan

HEADER = "t_device_s,t_host_s,seq,rate_dps,encoder_deg,temp_c"
AXES_HEADER = "gyro_x_dps,gyro_y_dps,gyro_z_dps,accel_x_mps2,accel_y_mps2,accel_z_mps2"
FORCE_DECIMALS = 5
MOST_DECIMALS = 9


@dataclass(frozen=True, slots=True)
class SessionBatch:
    """Sessions of one device, all with the same faults; `path` leads to their random numbers.

    mover
        What moves the device; None for a table with a motor.
    noise
        Name of the random numbers of noise and effects; empty for those of `path`. The motion does not depend on it.
    """

    device: DrawnDevice
    plans: tuple[SessionPlan, ...]
    faults: tuple[InjectedEffect, ...]
    path: DicePath
    mover: Mover | None = None
    noise: str = ""

    def write(self, folder: Path) -> None:
        """Each as a CSV file."""
        folder.mkdir(parents=True)
        for number in range(len(self.plans)):
            text = "\n".join(_lines(self.columns(number), self.device))
            (folder / f"session-{number + 1}.csv").write_text(text + "\n")

    def columns(self, number: int) -> Columns:
        """Measurements of one of them."""
        path = (*self.path, "session", number)
        scene = scene_of(self.plans[number], self.device.sample_hz, path, self.device.physics_hz, self.mover)
        return measure(scene, self.device, number, self.faults, (*path, self.noise) if self.noise else path)


def _lines(columns: Columns, device: DrawnDevice) -> list[str]:
    """Every digit that the device knows and none beyond."""
    rate = _decimals(device.dps_per_lsb)
    angle = _decimals(360.0 / device.encoder_cpr)
    row = f"%.6f,%.6f,%d,%.{rate}f,%.{angle}f,%.2f"
    values = [columns.t_device_s, columns.t_host_s, columns.seq, columns.rate_dps, columns.encoder_deg, columns.temp_c]
    header = HEADER
    if columns.axes is not None:
        header = f"{HEADER},{AXES_HEADER}"
        row += f",%.{rate}f" * 3 + f",%.{FORCE_DECIMALS}f" * 3
        values += [*columns.axes.gyro_dps.T, *columns.axes.accel_mps2.T]
    return [header, *(row % cells for cells in zip(*(column.tolist() for column in values), strict=True))]


def _decimals(step: float) -> int:
    """Decimals of a step that has few."""
    least = ceil(-log10(step))
    return next((n for n in range(least, MOST_DECIMALS) if abs(round(step, n) - step) < 1e-12), MOST_DECIMALS)
