"""Real recordings of a device, whole or in pieces, and a rig file that states what can be read off them.

They lie in the folder of further recordings (`recordings_support`). Without it there are none. A recording is a session
file, or an archive of numpy with a gyro on three axes (`gyr`, `quat`) or on one (`rate_dps`, `ref_deg`).
"""

from dataclasses import dataclass, replace
from functools import cache
from itertools import pairwise
from pathlib import Path

import numpy as np
from gyrogap.physics.motion import Floats, Mask
from gyrogap.physics.rig_text import rig_text
from numpy.typing import NDArray
from recordings_support import further_recordings
from scipy.spatial.transform import Rotation

LEAST_S = 21.0
"""A recording of 20 s is the shortest that is taken; one that loses rows at an end must still be as long."""

LEAST_SET_S = 60.0
"""Of all recordings of a set together."""

PIECE_S = 60.0
WHOLE_PIECES = 2.5
"""What is longer than so many pieces is cut into them."""

ANGLE_STEP_DEG = 1e-4
"""Rounding of a reference that is computed from attitudes. Chosen: a thousandth of the best optical one."""


@dataclass(frozen=True, slots=True)
class Owned:
    """A device of which there are recordings.

    pattern
        Of their file names, in the folder of further recordings.
    rates_hz
        Within which all of them were taken; one device was read at several rates.
    encoder_cpr
        Counts per turn of the reference.
    least_turned_deg
        Recordings that turned less are left out: a bench that stood still shows another device.
    each
        How many recordings a set gets at least; more, until they are a minute in all.
    axis
        Axis of the gyro in an archive.
    piece_s
        Length of a piece.
    dps_per_lsb, noise_dps_rthz
        Where they cannot be read off: the source has filtered the rate, or it is never calm. 16 bits of such a step
        hold the largest rate.
    """

    pattern: str
    rates_hz: tuple[float, float]
    encoder_cpr: int
    least_turned_deg: float
    each: int
    axis: str = "z"
    piece_s: float = PIECE_S
    dps_per_lsb: float | None = None
    noise_dps_rthz: float | None = None


OWNED = {
    "benchy": Owned("real/benchy_*.csv", (18.5, 19.3), 4096, 30.0, 3),
    "lsm9ds0": Owned("real/rasteiro_*_lsm9ds0.csv", (80.0, 140.0), 36000, 10.0, 3),
    "mpu6500": Owned("real/rasteiro_*_mpu6500rm3100.csv", (80.0, 140.0), 36000, 10.0, 2),
    "broad": Owned("broad_*.csv", (280.0, 290.0), 36000, 10.0, 3),
    "mpu6050_still": Owned("mpu6050_still.csv", (95.0, 105.0), 36000, -1.0, 3),
}
"""Devices from which two sets can be drawn at random."""

FURTHER = {
    "diodem": Owned("six/diodem_t2_*.npz", (39.0, 41.0), 3_600_000, 30.0, 3, "y", 22.0, 0.0305, 0.01),
    "openaxes": Owned("six/openaxes_*_radius.npz", (120.0, 130.0), 3_600_000, 30.0, 2, dps_per_lsb=0.002),
    "dart": Owned("aids/dart/dart_*.npz", (9.5, 10.5), 3_600_000, 30.0, 2, dps_per_lsb=0.0607, noise_dps_rthz=0.014),
    "car": Owned("real/smartloc_*.csv", (4.5, 5.5), 36000, 10.0, 2),
}
"""Devices with recordings enough for two fixed halves. They are no part of OWNED, whose drawn cases stay the same."""


@dataclass(frozen=True, slots=True)
class Rows:
    """A recording or a piece of one; columns by name, each of shape (n,), times from 0."""

    columns: dict[str, Floats]

    @property
    def t_s(self) -> Floats:
        """Device times."""
        return self.columns["t_device_s"]

    @property
    def seconds(self) -> float:
        """Length."""
        return float(self.t_s[-1] - self.t_s[0])

    @property
    def rate_hz(self) -> float:
        """Samples in a second, mean."""
        return (len(self.t_s) - 1) / self.seconds

    def with_columns(self, **columns: Floats) -> "Rows":
        """The same with other columns."""
        return replace(self, columns=self.columns | columns)

    def only(self, chosen: NDArray[np.intp] | Mask) -> "Rows":
        """Some of the rows, by number or mask."""
        return Rows({name: column[chosen] for name, column in self.columns.items()})

    def from_zero(self) -> "Rows":
        """Times and angle begin at 0, as those of a recording of its own do."""
        angle_deg = self.columns["encoder_deg"]
        first_deg = angle_deg[np.isfinite(angle_deg)][0]
        return self.with_columns(t_device_s=self.t_s - self.t_s[0], encoder_deg=angle_deg - first_deg)

    def text(self) -> str:
        """CSV."""
        lines = [",".join(self.columns), *(_row(cells) for cells in zip(*self.columns.values(), strict=True))]
        return "\n".join(lines) + "\n"


def _row(cells: tuple[float, ...]) -> str:
    return ",".join("" if np.isnan(cell) else f"{cell:.6f}".rstrip("0").rstrip(".") for cell in cells)


@dataclass(frozen=True, slots=True)
class Recorded:
    """Recordings as sessions."""

    recordings: tuple[Rows, ...]

    def write(self, folder: Path) -> None:
        """Each as a CSV file."""
        folder.mkdir(parents=True)
        for number, rows in enumerate(self.recordings, 1):
            (folder / f"session-{number}.csv").write_text(rows.text())


def devices() -> list[str]:
    """Those of which there are recordings enough for two sets of a minute each, and some to choose from."""
    return [name for name in OWNED if sum(rows.seconds for rows in recordings_of(name)) >= 2.5 * LEAST_SET_S]


@cache
def recordings_of(device: str) -> tuple[Rows, ...]:
    """All that are fit, in the order of their names; what is long, in pieces."""
    owned = (OWNED | FURTHER)[device]
    folder = further_recordings()
    read = [read_rows(path, owned.axis) for path in sorted(folder.glob(owned.pattern))] if folder else []
    pieces = [piece for rows in read for piece in _pieces(rows, owned.piece_s)]
    return tuple(piece for piece in pieces if _is_fit(piece, owned))


def _is_fit(rows: Rows, owned: Owned) -> bool:
    turned_deg = float(np.nanmax(rows.columns["encoder_deg"]) - np.nanmin(rows.columns["encoder_deg"]))
    low_hz, high_hz = owned.rates_hz
    return rows.seconds >= LEAST_S and low_hz <= rows.rate_hz <= high_hz and turned_deg > owned.least_turned_deg


def _pieces(rows: Rows, piece_s: float) -> list[Rows]:
    if rows.seconds <= WHOLE_PIECES * piece_s:
        return [rows.from_zero()]
    edges = np.searchsorted(rows.t_s, np.arange(rows.t_s[0], rows.t_s[-1], piece_s))
    return [rows.only(np.arange(first, last)).from_zero() for first, last in pairwise(edges)]


def read_rows(path: Path, axis: str = "z") -> Rows:
    """A CSV file, or an axis of an archive; an empty cell is NaN."""
    if path.suffix == ".npz":
        return _read_archive(path, axis)
    with path.open() as lines:
        names = next(lines).strip().split(",")
        values = np.genfromtxt(lines, delimiter=",").reshape(-1, len(names))
    return Rows(dict(zip(names, values.T, strict=True)))


def _read_archive(path: Path, axis: str) -> Rows:
    """From the first to the last known angle; the longest stretch of known attitudes."""
    with np.load(path) as archive:
        columns = {name: archive[name].astype(np.float64) for name in archive.files if name != "meta"}
    if "quat" in columns:
        part, index = _longest(np.isfinite(columns["quat"].sum(axis=1))), "xyz".index(axis)
        rate_dps, angle_deg = columns["gyr"][part, index], turned_about(columns["quat"][part])[:, index]
    else:
        first, *_, last = np.flatnonzero(np.isfinite(columns["ref_deg"])).tolist()
        part = slice(first, last + 1)
        rate_dps, angle_deg = columns["rate_dps"][part], columns["ref_deg"][part]
    angle_deg = np.round(angle_deg / ANGLE_STEP_DEG) * ANGLE_STEP_DEG
    return Rows({"t_device_s": columns["t"][part], "rate_dps": np.round(rate_dps, 4), "encoder_deg": angle_deg})


def turned_about(quaternions: Floats) -> Floats:
    """(n, 3) angles that the sensor has turned about its own axes, deg, from (n, 4) attitudes (w, x, y, z)."""
    attitudes = Rotation.from_quat(quaternions, scalar_first=True)
    steps = np.rad2deg((attitudes[:-1].inv() * attitudes[1:]).as_rotvec())
    return np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])


def _longest(is_known: Mask) -> slice:
    edges = np.flatnonzero(np.diff(np.concatenate([[0], is_known.astype(int), [0]]))).reshape(-1, 2)
    first, last = max(edges.tolist(), key=lambda stretch: stretch[1] - stretch[0])
    return slice(first, last)


def rig_of(device: str) -> str:
    """What its owner would write down: rate, count of the gyro, counts of the reference, noise where it is calmest."""
    owned, recordings = (OWNED | FURTHER)[device], recordings_of(device)
    rate_hz = float(np.median([rows.rate_hz for rows in recordings]))
    steps = np.concatenate([np.diff(np.unique(np.round(rows.columns["rate_dps"], 5))) for rows in recordings])
    step_dps = float(np.median(steps)) if owned.dps_per_lsb is None else owned.dps_per_lsb
    noise = owned.noise_dps_rthz or min(_calmest_dps(rows) for rows in recordings) / np.sqrt(rate_hz)
    base = {
        "sample_rate_hz": round(rate_hz, 2),
        "dps_per_lsb": max(float(f"{step_dps:.4g}"), 1e-4),
        "noise_dps_rthz": max(float(f"{noise:.3g}"), 1e-4),
        "bias_dps": 0.0,
        "encoder_cpr": owned.encoder_cpr,
        "host_delay_s": 0.002,
    }
    return rig_text(base)


def _calmest_dps(rows: Rows, window: int = 100) -> float:
    """Scatter of a sample, from differences of neighbours, in the quietest window that is not dead."""
    squares = np.square(np.diff(rows.columns["rate_dps"])) / 2.0
    means = np.convolve(squares, np.ones(window) / window, "valid")
    alive = means[means > 0.0]
    return float(np.sqrt(alive.min())) if len(alive) else 0.0
