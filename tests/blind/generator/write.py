"""A case as files: `sessions/` with CSV files and `rig.yaml`, nothing that says what is in them."""

from math import ceil, log10
from pathlib import Path

from blind.generator.bench import Columns, measure
from blind.generator.device import Device
from blind.generator.recipes import Recipe
from blind.generator.scene import scene_of

HEADER = "t_device_s,t_host_s,seq,rate_dps,encoder_deg,temp_c"
MOST_DECIMALS = 9


def write_case(recipe: Recipe, folder: Path) -> None:
    """Generate and write; the same recipe gives the same bytes."""
    (folder / "sessions").mkdir(parents=True)
    (folder / "rig.yaml").write_text(recipe.rig.text(recipe.device))
    for number in range(len(recipe.sessions)):
        text = "\n".join(_lines(session_columns(recipe, number), recipe.device))
        (folder / "sessions" / f"session-{number + 1}.csv").write_text(text + "\n")


def session_columns(recipe: Recipe, number: int) -> Columns:
    """Measurements of one session."""
    path = (*recipe.path, "session", number)
    scene = scene_of(recipe.sessions[number], recipe.device.sample_hz, path)
    return measure(scene, recipe.device, number, recipe.faults, path)


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
