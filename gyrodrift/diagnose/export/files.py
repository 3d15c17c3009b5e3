"""Exports of a diagnosis as files in a folder."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from types import MappingProxyType

from gyrodrift.diagnose.export import effects_json, gazebo, kalibr, mujoco
from gyrodrift.diagnose.export.exported import exported_of
from gyrodrift.diagnose.export.formats import Express, FormatExport
from gyrodrift.diagnose.result import Diagnosis
from gyrodrift.io.files import write_whole

FOLDER = "export"

FORMATS: Mapping[str, Express] = MappingProxyType(
    {
        "gazebo": gazebo.gazebo,
        "kalibr": kalibr.kalibr,
        "mujoco": mujoco.mujoco,
        "json": effects_json.effects_json,
    }
)
"""Formats by the word of `--export`."""

NAMES = (gazebo.FILE, kalibr.FILE, mujoco.XML, mujoco.CALLBACK, effects_json.FILE)
"""Names of all files that an export may have."""


def exports_of(diagnosis: Diagnosis, formats: Sequence[str]) -> tuple[FormatExport, ...]:
    """The diagnosed effects in each of the formats, each once."""
    exported = exported_of(diagnosis)
    return tuple(FORMATS[name](exported) for name in dict.fromkeys(formats))


def write_exports(folder: Path, exports: Sequence[FormatExport]) -> None:
    """Write the files to `folder/export`, and remove those of earlier runs that were not asked for now.

    Raises
    ------
    UsageError
        A file cannot be written.
    """
    texts = {name: text for export in exports for name, text in export.files.items()}
    for name in NAMES:
        if name not in texts:
            (folder / FOLDER / name).unlink(missing_ok=True)
    if texts:
        (folder / FOLDER).mkdir(parents=True, exist_ok=True)
    for name, text in texts.items():
        write_whole(folder / FOLDER / name, [text])


def export_line(export: FormatExport) -> str:
    """Summary of the effects in an export and of those that it lacks, in a line."""
    where = " and ".join(f"{FOLDER}/{name}" for name in export.files)
    has = ", ".join(export.expressed) or "no effect"
    lacks = "".join(f"; not {name}: {why}" for name, why in export.not_expressed.items())
    return f"{where}: {has}, with the measured noise{lacks}"
