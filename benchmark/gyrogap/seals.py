"""Seals: salted hashes of labels are published, each opening is checked against them and logged."""

import json
from collections.abc import Mapping
from datetime import UTC, datetime
from hashlib import sha256
from pathlib import Path
from typing import Any

from gyrodrift.io.files import UnreadableError, check_ordinary
from gyrodrift.values.errors import DataError, UsageError, printable
from gyrogap.json_files import object_of, read_json, write_json

HASHES, OPENINGS = "hashes.json", "openings.log"

LABEL: dict[str, type] = {
    "case": str,
    "seed": int,
    "row": str,
    "number": int,
    "size": str,
    "effects": list,
    "about": str,
}
EFFECT: dict[str, type] = {"name": str, "parameters": dict}
"""Keys that are used of a label and of an effect in it, and the types of their values."""


class BrokenSealError(DataError):
    """The label in a seal is not the one whose hash was published."""


def hash_of(salt: str, label: Mapping[str, Any]) -> str:
    """SHA-256 of the salt and the label in a canonical form."""
    text = json.dumps(label, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
    return sha256((salt + text).encode()).hexdigest()


def seal_label(folder: Path, salt: str, label: Mapping[str, Any]) -> str:
    """Write a label with its salt into the folder of seals; its hash."""
    plain = json.loads(json.dumps(label))  # as it will be read
    write_json(folder / f"{label['case']}.json", {"salt": salt, "label": plain})
    return hash_of(salt, plain)


def _log_opening(path: Path, line: str) -> None:
    try:
        check_ordinary(path)
        with path.open("a") as log:
            log.write(f"{line}\n")
    except (OSError, UnreadableError) as error:
        why = getattr(error, "strerror", None) or str(error)
        raise UsageError(f"{path}: cannot be written, and no seal is opened without it: {why}") from error


def open_seal(folder: Path, seals: Path, case: str, why: str) -> dict[str, Any]:
    """Label of a case of the set in `folder`; the opening is logged first.

    Raises
    ------
    BrokenSealError
        The label is not the one that was sealed.
    DataError
        There is no seal.
    """
    now = datetime.now(UTC).isoformat(timespec="seconds")
    _log_opening(folder / OPENINGS, printable(f"{now} {case} {why}"))
    path = seals / f"{case}.json"
    seal = object_of(read_json(path), {"salt": str, "label": dict}, path, "a seal")
    for effect in object_of(seal["label"], LABEL, path, "the label")["effects"]:
        object_of(effect, EFFECT, path, "an effect")
    published = object_of(read_json(folder / HASHES), {case: str}, folder / HASHES, "the list of hashes")[case]
    if published != hash_of(seal["salt"], seal["label"]) or seal["label"]["case"] != case:
        raise BrokenSealError(f"{path}: is not the label that was sealed; its hash differs from {folder / HASHES}")
    label: dict[str, Any] = seal["label"]
    return label
