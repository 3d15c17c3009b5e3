"""A case as files: `sessions/` with CSV files and `rig.yaml`, nothing that says what is in them."""

from dataclasses import dataclass
from math import ceil, log10
from pathlib import Path

from blind.generator.bench import Columns, measure
from blind.generator.device import Device
from blind.generator.dice import Path as DicePath
from blind.generator.driven import Mover
from blind.generator.kinds import Fault
from blind.generator.recipes import Recipe
from blind.generator.scene import scene_of
from blind.generator.sessions import SessionPlan

HEADER = "t_device_s,t_host_s,seq,rate_dps,encoder_deg,temp_c"
MOST_DECIMALS = 9


def write_case(recipe: Recipe, folder: Path) -> None:
    """Generate and write; the same recipe gives the same bytes."""
    batch_of(recipe).write(folder / "sessions")
    (folder / "rig.yaml").write_text(recipe.rig.text(recipe.device))


def session_columns(recipe: Recipe, number: int) -> Columns:
    """Measurements of one session."""
    return batch_of(recipe).columns(number)


@dataclass(frozen=True, slots=True)
class Batch:
    """Sessions of one device, all with the same faults; `path` leads to their random numbers.

    mover
        What moves the device; None for a table with a motor.
    """

    device: Device
    plans: tuple[SessionPlan, ...]
    faults: tuple[Fault, ...]
    path: DicePath
    mover: Mover | None = None

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
        return measure(scene, self.device, number, self.faults, path)


def batch_of(recipe: Recipe) -> Batch:
    """The sessions of a recipe."""
    return Batch(recipe.device, recipe.sessions, recipe.faults, recipe.path)


def _lines(columns: Columns, device: Device) -> list[str]:
    """Every digit that the device knows and none beyond."""
    rate = _decimals(device.dps_per_lsb)
    angle = _decimals(360.0 / device.encoder_cpr)
    row = f"%.6f,%.6f,%d,%.{rate}f,%.{angle}f,%.2f"
    values = (columns.t_device_s, columns.t_host_s, columns.seq, columns.rate_dps, columns.encoder_deg, columns.temp_c)
    return [HEADER, *(row % cells for cells in zip(*(column.tolist() for column in values), strict=True))]


def _decimals(step: float) -> int:
    """Decimals of a step that has few."""
    least = ceil(-log10(step))
    return next((n for n in range(least, MOST_DECIMALS) if abs(round(step, n) - step) < 1e-12), MOST_DECIMALS)
