"""An output of one file, as docs/extending-output.md describes it: it notes the last yaw in a file."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from gyrodrift.sample import Corrected


def open_output(options: Mapping[str, Any]) -> "LastYaw":
    """`path` names the file."""
    return LastYaw(Path(options["path"]))


class LastYaw:
    """Writes the yaw of the last sample whenever some have come."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._samples = 0

    def take(self, samples: list[Corrected]) -> None:
        if samples:
            self._samples += len(samples)
            self._path.write_text(f"{samples[-1].yaw_deg:.3f}\n")

    def tick(self, now_s: float) -> None:
        pass

    def stats(self) -> dict[str, Any]:
        return {"noted": self._samples}

    def wakes(self) -> Mapping[int, int]:
        return {}

    def close(self) -> None:
        pass
