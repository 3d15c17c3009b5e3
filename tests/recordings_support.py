"""Recordings of real sensors: those in `tests/data`, and further ones in a folder beside the project."""

import lzma
import os
from dataclasses import dataclass
from itertools import accumulate
from pathlib import Path

import pytest

DATA = Path(__file__).parent / "data"
FOLDER_VARIABLE = "GYRODRIFT_RECORDINGS"
"""Names the folder of further recordings; without it, the folder is looked for beside the project."""

BROAD_PERIOD_S = 0.0035
BROAD_LSB_DPS = 2000.0 / 32767.0
BROAD_ENCODER_STEP_DEG = 1e-4


@dataclass(frozen=True, slots=True)
class Recordings:
    """Files by name, without `.csv`; those in `tests/data` are unpacked into a folder when they are asked for."""

    unpacked: Path

    def path(self, name: str) -> Path:
        """A session file. The test is skipped where only the further folder has it and that is absent."""
        further = further_recordings()
        if name in packed_names():
            return self._unpack(name)
        if further is None:
            pytest.skip(f"{name} is not in tests/data, and there is no folder of further recordings")
        return next(further.rglob(f"{name}.csv"))

    def packed(self, pattern: str = "*") -> list[Path]:
        """All session files in `tests/data` whose names match."""
        return [self._unpack(name) for name in packed_names(pattern)]

    def further(self, pattern: str = "*") -> list[Path]:
        """All session files in the further folder whose names match; the test is skipped without the folder."""
        folder = further_recordings()
        if folder is None:
            pytest.skip("there is no folder of further recordings")
        return sorted(path for path in folder.rglob(f"{pattern}.csv") if b"t_device_s" in path.read_bytes()[:200])

    def _unpack(self, name: str) -> Path:
        path = self.unpacked / f"{name}.csv"
        if not path.exists():
            path.write_text(_text_of(name))
        return path


def further_recordings() -> Path | None:
    """The folder that the environment names, or a folder `data` beside the project with recordings in it."""
    named = os.environ.get(FOLDER_VARIABLE)
    if named:
        return Path(named)
    return next((path.parent for path in DATA.parents[2].glob("*/data/broad_01.csv")), None)


def packed_names(pattern: str = "*") -> list[str]:
    """Names of the recordings in `tests/data`."""
    return sorted(path.name.partition(".")[0] for path in DATA.glob(f"{pattern}.csv.xz"))


def _text_of(name: str) -> str:
    steps = DATA / f"{name}.steps.csv.xz"
    if steps.exists():
        return _broad_text(lzma.decompress(steps.read_bytes()).decode())
    return lzma.decompress((DATA / f"{name}.csv.xz").read_bytes()).decode()


def _broad_text(steps: str) -> str:
    """The session of a table of first differences of the rate and second differences of the angle, in counts."""
    pairs = [line.split(",") for line in steps.splitlines()]
    rates = accumulate(int(rate) for rate, _ in pairs)
    angles = accumulate(accumulate(int(angle) for _, angle in pairs))
    rows = [
        f"{index * BROAD_PERIOD_S:.5f},{rate * BROAD_LSB_DPS:.4f},{angle * BROAD_ENCODER_STEP_DEG:.4f}\n"
        for index, (rate, angle) in enumerate(zip(rates, angles, strict=True))
    ]
    return "t_device_s,rate_dps,encoder_deg\n" + "".join(rows)
