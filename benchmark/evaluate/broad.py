"""The BROAD benchmark: root mean square errors of heading and inclination while moving, for filters of six axes.

    python -m benchmark evaluate.broad FOLDER        a checkout of the data set's repository (dlaidig/broad, CC BY 4.0)

Laidig, Caruso, Cereatti and Seel, "BROAD - A Benchmark for Robust Inertial Orientation Estimation", Data 6(7), 2021.
The error is that of estimate times inverse reference in the earth frame: its heading 2·atan|z/w|, its inclination
2·acos √(w² + z²). Six axes have no north, so the mean heading error of the rest before the first movement is taken off.
Beside ours stand the published figures of the repository, of filters with a magnetometer.
"""

import json
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.io import loadmat
from scipy.spatial.transform import Rotation

from gyrodrift.filters.attitude.model import AttitudeState, coefficients
from gyrodrift.filters.attitude.step import step
from gyrodrift.filters.restlevel.model import RestlevelParams
from gyrodrift.values.arrays import Floats, Mask

Attitudes = Callable[["Trial"], Floats]
GROUPS = ("undisturbed", "disturbed")


@dataclass(frozen=True, slots=True)
class Trial:
    """A recording: times in s; gyro in rad/s and accelerometer in m/s² (n, 3); reference (w, x, y, z); motion mask."""

    name: str
    t_s: Floats
    gyro_rps: Floats
    accel_mps2: Floats
    reference: Floats
    is_moving: Mask


@dataclass(frozen=True, slots=True)
class TrialErrors:
    """Root mean squares over the movement, deg."""

    heading_deg: float
    inclination_deg: float


def load_trial(path: Path) -> Trial:
    """A trial of `data_mat`."""
    fields = loadmat(path)
    gyro_rps, accel_mps2 = (np.ascontiguousarray(fields[name], dtype=np.float64) for name in ("imu_gyr", "imu_acc"))
    t_s = np.arange(len(gyro_rps)) / float(np.squeeze(fields["sampling_rate"]))
    is_moving = np.squeeze(fields["movement"]).astype(np.bool_)
    return Trial(path.stem, t_s, gyro_rps, accel_mps2, np.asarray(fields["opt_quat"], dtype=np.float64), is_moving)


def trial_errors(estimate: Floats, trial: Trial) -> TrialErrors:
    """Errors of attitudes (n, 4); samples without a reference are left out."""
    is_whole = np.isfinite(trial.reference.sum(axis=1))
    difference = _rotation(estimate[is_whole]) * _rotation(trial.reference[is_whole]).inv()
    is_moving: Mask = trial.is_moving[is_whole]
    w, _, _, z = np.asarray(difference.as_quat(scalar_first=True), dtype=np.float64).T
    heading_deg = np.rad2deg(2.0 * np.arctan2(z, w))
    before = heading_deg[: max(1, int(is_moving.argmax()))]
    start_deg = np.rad2deg(np.angle(np.exp(1j * np.deg2rad(before)).mean()))
    heading_deg = (heading_deg - start_deg + 180.0) % 360.0 - 180.0
    inclination_deg = np.rad2deg(2.0 * np.arccos(np.clip(np.hypot(w, z), 0.0, 1.0)))
    return TrialErrors(*(float(np.sqrt((error[is_moving] ** 2).mean())) for error in (heading_deg, inclination_deg)))


def _rotation(quaternions: Floats) -> Rotation:
    return Rotation.from_quat(quaternions, scalar_first=True)


def attitude_filter(trial: Trial) -> Floats:
    """The attitude filter at its defaults."""
    c, state, attitudes = coefficients(RestlevelParams()), AttitudeState(), np.empty((len(trial.t_s), 4))
    columns = (trial.t_s.tolist(), np.rad2deg(trial.gyro_rps).tolist(), trial.accel_mps2.tolist())
    for row, (t_s, gyro_dps, accel_mps2) in enumerate(zip(*columns, strict=True)):
        step(c, state, t_s, *gyro_dps, *accel_mps2)
        attitudes[row] = state.q
    return attitudes


def vqf(trial: Trial) -> Floats:
    """VQF at the defaults of its package."""
    from vqf import VQF  # noqa: PLC0415 - an optional package

    estimate: Floats = VQF(float(np.diff(trial.t_s).mean())).updateBatch(trial.gyro_rps, trial.accel_mps2)["quat6D"]
    return estimate


FILTERS: dict[str, Attitudes] = {"gyrodrift": attitude_filter, "VQF, six axes": vqf}


def published(folder: Path) -> Iterator[tuple[str, dict[str, TrialErrors]]]:
    """Mean errors by group from the repository's own results, at the best common parameters."""
    for path in sorted((folder / "example_code" / "out").glob("results_*_average_rmse.json")):
        groups = json.loads(path.read_text())["groups"]
        means = {name: groups[name]["tagp_parameters"] for name in ("all_trials", *GROUPS)}
        name = f"{path.stem.removeprefix('results_').removesuffix('_average_rmse')}, nine axes, published"
        yield name, {k: TrialErrors(v["heading_rmse_deg"], v["inclination_rmse_deg"]) for k, v in means.items()}


def report(folder: Path) -> Iterator[str]:
    """Lines of a table: median and mean over trials, and the means that were published."""
    trials = [load_trial(path) for path in sorted((folder / "data_mat").glob("[0-9]*.mat"))]
    yield f"{len(trials)} trials; heading: median / mean, inclination: median / mean, deg"
    for name, attitudes in FILTERS.items():
        errors = {trial.name: trial_errors(attitudes(trial), trial) for trial in trials}
        for group in ("all_trials", *GROUPS):
            chosen = [error for key, error in errors.items() if group == "all_trials" or f"_{group}" in key]
            if chosen:
                rows = (_row([getattr(e, field) for e in chosen]) for field in ("heading_deg", "inclination_deg"))
                yield f"{name:32}{group:14}{'  '.join(rows)}"
    for name, means in published(folder):
        for group, mean in means.items():
            yield f"{name:32}{group:14}     – / {mean.heading_deg:5.2f}      – / {mean.inclination_deg:5.2f}"


def _row(errors_deg: list[float]) -> str:
    return f"{np.median(errors_deg):6.2f} / {np.mean(errors_deg):5.2f}"


def main(arguments: list[str]) -> int:
    """Print the table; 2 without a folder with `data_mat`."""
    if len(arguments) != 1 or not (Path(arguments[0]) / "data_mat").is_dir():
        print(f"{__doc__}\nexpected a folder with data_mat in it", file=sys.stderr)
        return 2
    for line in report(Path(arguments[0])):
        print(line, flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
