"""A simulated twin of a published data set: sessions of the same lengths with the same drift without correction.

The table has a row per session: split, session, minutes, and E of Euler integration (the mean absolute yaw error in
degrees). For each row a search finds the bias track that gives this E: a constant, a 1/f part and a random walk, all
scaled by one strength. The rest of the rig does not change.
"""

import csv
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import inf
from pathlib import Path

import numpy as np

from firmware_sim.effects.sensor_bias import BiasInstability, RateRandomWalk
from firmware_sim.motion.profile import Profile, load_profile
from firmware_sim.rig import Rig, with_effects
from gyrodrift.io.files import write_whole
from gyrodrift.session.files import write_session
from gyrodrift.session.session import Session
from gyrodrift.simulation.sessions import Simulation, euler_error_deg, rig_yaml
from gyrodrift.values.errors import DataError

BIAS_DPS = 0.1
FLOOR_DPH = 40.0
WALK_DPS_RTS = 0.001
"""Bias track at strength 1: the bias of a low-cost gyro some hours after a calibration."""

CLOSE_ENOUGH_DEG = 5e-4
"""A few steps of E: rounding of single samples to counts moves it by about 0.0001 deg."""

MOST_TRIES = 20

TABLE = "twin.csv"

SHORTEST_MINUTES, LONGEST_MINUTES = 0.01, 1440.0
LONGEST_WORD = 60
"""Characters of a file name."""


@dataclass(frozen=True, slots=True)
class Row:
    """A session of the published set."""

    split: str
    name: str
    minutes: float
    e_euler_deg: float


@dataclass(frozen=True, slots=True)
class Twin:
    """A simulated session with the drift of a published one."""

    row: Row
    path: Path
    strength: float
    e_euler_deg: float


def read_rows(path: Path) -> list[Row]:
    """The rows of a table with the columns split, session, minutes and e_euler_deg.

    Raises
    ------
    DataError
        The table cannot be read or lacks a column.
    """
    try:
        with path.open(encoding="utf-8") as file:
            lines = csv.DictReader(line for line in file if not line.startswith("#"))
            rows = [
                Row(line["split"] or "", line["session"] or "", float(line["minutes"]), float(line["e_euler_deg"]))
                for line in lines
            ]
    except (OSError, UnicodeDecodeError) as error:
        raise DataError(f"{path}: cannot be read: {error}") from error
    except (csv.Error, KeyError, TypeError, ValueError) as error:
        raise DataError(
            f"{path}: expected columns split, session, minutes, e_euler_deg with numbers: {error}"
        ) from error
    for row in rows:
        if not (SHORTEST_MINUTES <= row.minutes <= LONGEST_MINUTES and 0.0 <= row.e_euler_deg < inf):
            raise DataError(
                f"{path}: {row.name}: {row.minutes:g} minutes with {row.e_euler_deg:g} deg; expected "
                f"{SHORTEST_MINUTES:g} to {LONGEST_MINUTES:g} minutes and an error of at least 0"
            )
    return rows


def write_twins(rows: list[Row], rig: Rig, folder: Path, seed: int, ending: str = "mcap") -> Iterator[Twin]:
    """Write the session and the rig of each row to `folder/SPLIT/`, and the table of results to `folder/twin.csv`."""
    twins: list[Twin] = []
    for number, row in enumerate(rows):
        profile = load_profile("rest" if "still" in row.name else "turntable")
        strength, session = find_strength(row, rig, profile, seed, number)
        path = _path(folder, number, row, ending)
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path.with_suffix(".rig.yaml"), [rig_yaml(drifting(rig, strength))])
        write_session(path, [session])
        twins.append(Twin(row, path, strength, _mean_abs(session)))
        yield twins[-1]
    header = "split,session,minutes,e_euler_published_deg,e_euler_deg,strength\n"
    lines = [
        f"{t.row.split},{t.row.name},{t.row.minutes!r},{t.row.e_euler_deg!r},{t.e_euler_deg:.6f},{t.strength!r}\n"
        for t in twins
    ]
    write_whole(folder / TABLE, [header, *lines])


def twin_paths(rows: list[Row], folder: Path, ending: str = "mcap") -> list[Path]:
    """Paths of the sessions of `write_twins` and of their table."""
    return [*(_path(folder, number, row, ending) for number, row in enumerate(rows)), folder / TABLE]


def _path(folder: Path, number: int, row: Row, ending: str) -> Path:
    return folder / _plain(row.split) / f"{number + 1:02d}-{_plain(row.name)}.{ending}"


def _plain(text: str) -> str:
    """A word of a table as a safe name of a file or folder."""
    return re.sub(r"[^0-9A-Za-z]+", "-", text)[:LONGEST_WORD].strip("-")


def find_strength(row: Row, rig: Rig, profile: Profile, seed: int, number: int) -> tuple[float, Session]:
    """Strength of the bias track that gives the E of a row, and its session.

    At every moment the error is linear in the strength, except for the rounding to counts. Two simulations therefore
    give a first value, and a few Newton steps refine it.

    Raises
    ------
    DataError
        No strength gives this E, because the noise alone drifts further.
    """
    try:
        solution = _strength(row, rig, profile, seed, number)
    except (ArithmeticError, ValueError):  # beyond the limits of a rig, or of floats
        solution = None
    if solution is None:
        raise DataError(
            f"{row.name}: no bias track of this rig gives E = {row.e_euler_deg:g} deg; is its noise too high?"
        )
    return solution


def _strength(row: Row, rig: Rig, profile: Profile, seed: int, number: int) -> tuple[float, Session] | None:
    """Strength and session; None if a few steps do not converge."""

    def simulated(strength: float) -> Session:
        return Simulation(drifting(rig, strength), profile, seed, number, row.minutes).whole()

    without, at_one = (euler_error_deg(simulated(strength)) for strength in (0.0, 1.0))
    track = at_one - without

    def predicted_deg(strength: float) -> float:
        return float(np.mean(np.abs(without + strength * track)))

    strength = _solve(predicted_deg, row.e_euler_deg)
    for _ in range(MOST_TRIES):
        session = simulated(strength)
        missing_deg = row.e_euler_deg - _mean_abs(session)
        if abs(missing_deg) <= CLOSE_ENOUGH_DEG:
            return strength, session
        slope = (predicted_deg(1.001 * strength) - predicted_deg(0.999 * strength)) / (0.002 * strength)
        strength += missing_deg / slope
    return None


def _solve(predicted_deg: Callable[[float], float], e_deg: float) -> float:
    """Strength at which the predicted error reaches `e_deg`, by bisection."""
    low, high = 0.0, 1.0
    while predicted_deg(high) < e_deg:
        low, high = high, 2.0 * high
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if predicted_deg(middle) < e_deg else (low, middle)
    return high


def drifting(rig: Rig, strength: float) -> Rig:
    """The rig with a bias track of this strength."""
    base = rig.base.model_copy(update={"bias_dps": BIAS_DPS * strength})
    track = [
        BiasInstability(floor_dph=FLOOR_DPH * strength),
        RateRandomWalk(density_dps_rts=WALK_DPS_RTS * strength),
    ]
    return with_effects(rig.model_copy(update={"base": base}), track)


def _mean_abs(session: Session) -> float:
    return float(np.mean(np.abs(euler_error_deg(session))))
