"""Sealed labels: hashes are published before the run, every opening is checked against them and logged."""

import json
import secrets
from collections.abc import Iterable
from datetime import UTC, datetime
from typing import Any

from gyrogap.json_files import write_json
from gyrogap.seals import hash_of

from blind.folder import SetFolder

SALT_BYTES = 16


class BrokenSealError(Exception):
    """The label in a seal is not the one whose hash was published."""


def seal(folder: SetFolder, labels: Iterable[dict[str, Any]]) -> None:
    """Put every label under a seal and publish the hashes, beside those that are published already."""
    hashes = folder.hashes()
    for label in labels:
        salt = secrets.token_hex(SALT_BYTES)
        plain = json.loads(json.dumps(label))  # as it will be read again
        hashes[label["case"]] = hash_of(salt, plain)
        write_json(folder.seal(label["case"]), {"salt": salt, "label": plain})
    folder.write("hashes.json", dict(sorted(hashes.items())))


def open_seal(folder: SetFolder, case: str, why: str) -> dict[str, Any]:
    """The label of a case; the opening is logged first.

    Raises
    ------
    BrokenSealError
        Where it is not what was sealed.
    """
    now = datetime.now(UTC).isoformat(timespec="seconds")
    with folder.openings.open("a") as log:
        log.write(f"{now} {case} {why}\n")
    sealed = json.loads(folder.seal(case).read_text())
    label: dict[str, Any] = sealed["label"]
    if folder.hashes().get(case) != hash_of(sealed["salt"], label) or label["case"] != case:
        raise BrokenSealError(f"{case}: the label is not the one that was sealed")
    return label
