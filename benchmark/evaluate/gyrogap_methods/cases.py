"""Cases of a data set as arrays, for methods that are not gyrodrift, and the writing of answers."""

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np
import yaml
from gyrogap.features import features_of
from gyrogap.physics.bench import AxisColumns, Columns
from gyrogap.vocabulary import PARAMETERS

Answer = dict[str, Any]
Features = dict[str, float]


@dataclass(frozen=True, slots=True)
class PublicCase:
    """What a method sees: the sessions and the file of the simulator."""

    name: str
    sessions: list[Columns]
    simulator: dict[str, Any]


def read_session(path: Path) -> Columns:
    """Columns of a session file."""
    values = np.loadtxt(path, delimiter=",", skiprows=1).T
    axes = AxisColumns(values[6:9].T, values[9:12].T) if len(values) > 6 else None
    t_device_s, t_host_s, seq, rate_dps, encoder_deg, temp_c = values[:6]
    return Columns(t_device_s, t_host_s, seq, rate_dps, encoder_deg, temp_c, axes)


def read_case(folder: Path) -> PublicCase:
    """The case of a folder."""
    simulator = yaml.safe_load((folder / "simulator.yaml").read_text())
    return PublicCase(folder.name, [read_session(path) for path in sorted(folder.glob("sessions/*.csv"))], simulator)


def read_cases(data: Path) -> Iterator[PublicCase]:
    """All cases of a data set."""
    return (read_case(folder) for folder in sorted((data / "cases").iterdir()))


def answer_all(data: Path, answers: Path, method: Callable[[PublicCase], Answer]) -> None:
    """Write the answer of a method to each case, and print the CPU time per case."""
    answers.mkdir(parents=True, exist_ok=True)
    started_s, count = process_time(), 0
    for case in read_cases(data):
        (answers / f"{case.name}.json").write_text(json.dumps(method(case)) + "\n")
        count += 1
    print(f"{count} cases, {(process_time() - started_s) / max(count, 1):.2f} s of CPU each")


def case_features(sessions: list[Columns], simulator: dict[str, Any]) -> Features:
    """Features for a learner: mean and spread over sessions, and what the simulator states."""
    measured = [features_of(columns) for columns in sessions]
    names = sorted({name for features in measured for name in features})
    values = {name: np.array([features.get(name, np.nan) for features in measured]) for name in names}
    base = simulator["base"]
    means = {name: float(np.nanmean(array)) for name, array in values.items() if np.isfinite(array).any()}
    spreads = {f"{name} spread": float(np.nanstd(values[name])) for name in means}
    return means | spreads | _against(base, means) | _stated(simulator)


def _against(base: dict[str, Any], means: Features) -> Features:
    """What is measured against what the simulator states."""
    noise_dps = base["noise_dps_rthz"] * np.sqrt(base["sample_rate_hz"])
    return {
        "noise": means["residual"] - float(np.log(noise_dps)),
        "steps": means.get("step", np.nan) - float(np.log(base["dps_per_lsb"])),
        "lines": means.get("counts", np.nan) - float(np.log(base["encoder_cpr"])),
        "sample rate": float(base["sample_rate_hz"]),
        "log noise": float(np.log(noise_dps)),
        "log cpr": float(np.log(base["encoder_cpr"])),
        "log step": float(np.log(base["dps_per_lsb"])),
        "absolute": float(base["encoder_absolute"]),
    }


def _stated(simulator: dict[str, Any]) -> Features:
    """Strength of each effect that the simulator has."""
    stated = {effect["name"]: effect for effect in simulator["effects"]}
    return {
        f"stated {name}": float(stated[name].get(parameters[0].name, 0.0)) if name in stated else 0.0
        for name, parameters in PARAMETERS.items()
    }
