"""A made-up board that is turned by hand: any columns in any form, with the truth beside them."""

import json
from dataclasses import dataclass
from math import radians

import numpy as np

from gyrodrift.columns.turn.motion import TurnWindow
from gyrodrift.columns.turn.series import TimedLine
from gyrodrift.values.arrays import Floats

PER_DPS = {
    "dps": 1.0,
    "rads": radians(1.0),
    "mdps": 1e3,
    "mrads": 1e3 * radians(1.0),
    "deg/min": 60.0,
    "0.1 deg/s": 10.0,
    "131": 131.0,
    "65.5": 65.5,
    "16.4": 16.4,
    "114.28": 114.28,
    "14.29": 14.29,
}
DIGITS = {"dps": (1, 2, 4), "rads": (3, 4, 6), "mdps": (0, 1), "mrads": (1, 2), "deg/min": (0, 1)}
PER_G = {"g": (1.0, 3), "mps2": (9.80665, 2), "mg": (1e3, 0), "2 g": (16384.0, 0), "4 g": (8192.0, 0)}
MARKS = {"comma": ",", "tab": "\t", "space": " ", "semicolon": ";"}
CLOCKS = {"ms": (1e3, 0), "us": (1e6, 0), "s": (1.0, 3)}
OVERSHOOT_S, MOST_OVERSHOOT_DEG = 0.8, 8.0
"""A hand turns too far and comes back."""

REST_S, REACTION_S, AFTER_S = 3.0, 0.6, 3.0


@dataclass(frozen=True)
class TurnedBoard:
    """Lines of a board and what is true of them.

    rate, angle
        Label or place of the column that holds it, with the factor to deg/s or degrees; None where none does.
    """

    lines: list[TimedLine]
    window: TurnWindow
    rate: tuple[str | int, float] | None
    angle: tuple[str | int, float] | None
    about: str = ""


def hand_turn(
    rng: np.random.Generator, turned_deg: float, rate_hz: float, lasts_s: float
) -> tuple[Floats, Floats, Floats]:
    """Times s, rate deg/s and angle deg of a rest, a quarter turn of a hand to the left, and a rest."""
    t_s = np.arange(0.0, REST_S + REACTION_S + lasts_s + AFTER_S, 1.0 / rate_hz)
    phase = np.clip((t_s - REST_S - REACTION_S) / lasts_s, 0.0, 1.0) ** rng.uniform(0.7, 1.4)
    angle_deg = turned_deg * (phase - np.sin(2.0 * np.pi * phase) / (2.0 * np.pi))
    after = np.clip((t_s - REST_S - REACTION_S - 0.9 * lasts_s) / OVERSHOOT_S, 0.0, 1.0)
    angle_deg = angle_deg + rng.uniform(0.0, MOST_OVERSHOOT_DEG) * np.sin(np.pi * after) ** 2
    return t_s, np.gradient(angle_deg, t_s), angle_deg


class _Maker:
    """Draws columns of a board that turns; `places` has those of the rate and the angle."""

    def __init__(self, rng: np.random.Generator) -> None:
        rate_hz = float(rng.choice([5, 10, 25, 50, 100, 200]))
        lasts_s = float(rng.uniform(max(0.7, 6.0 / rate_hz), 5.0))
        self.rng = rng
        self.turned_deg = float(rng.uniform(80.0, 100.0))
        self.t_s, self.rate_dps, self.angle_deg = hand_turn(rng, self.turned_deg, rate_hz, lasts_s)
        self.is_moving = np.abs(self.rate_dps) > 0.5
        self.sign = float(rng.choice([-1.0, 1.0]))
        self.unit = str(rng.choice(list(PER_DPS)))
        self.angle_factor = self.sign
        self.vertical = int(rng.choice([2, 2, 2, 1, 0]))
        self.prefix = str(rng.choice(["g", "gyro_"]))
        self.labels: list[str] = []
        self.texts: list[list[str]] = []
        self.places: dict[str, int] = {}
        self.about = f"{self.unit}, {self.turned_deg:.0f} deg in {lasts_s:.1f} s at {rate_hz:g} Hz"

    def add(self, label: str, values: Floats, digits: int) -> None:
        self.labels.append(label)
        self.texts.append([f"{value:.{digits}f}" for value in values])

    def noise(self, size: float) -> Floats:
        return self.rng.normal(0.0, size, len(self.t_s))

    def clock(self) -> None:
        name = str(self.rng.choice(list(CLOCKS)))
        per_s, digits = CLOCKS[name]
        self.add(f"t_{name}", (self.t_s + self.rng.uniform(0, 500)) * per_s, digits)

    def gyro(self) -> None:
        """Each axis has a bias; those that lie take up to 15 % of the turn, and the wobble of the hand."""
        rng, size = self.rng, float(self.rng.choice([0.02, 0.05, 0.2]))
        for axis, name in enumerate("xyz"):
            dps = rng.normal(0.0, 2.0) + self.noise(size)
            if axis == self.vertical:
                self.places["rate"] = len(self.labels)
                dps = dps + self.sign * self.rate_dps
            else:
                wobble = rng.normal(0, 2.0) * np.sin(9.0 * self.t_s + rng.uniform(0, 6)) * self.is_moving
                dps = dps + rng.uniform(-0.15, 0.15) * self.rate_dps + wobble
            digits = int(rng.choice(DIGITS.get(self.unit, (0,))))
            self.add(f"{self.prefix}{name}", dps * PER_DPS[self.unit], digits)

    def angles(self) -> None:
        """Yaw with its jump anywhere, and two angles that hardly move."""
        rng, is_deg = self.rng, bool(self.rng.random() < 0.5)
        full, digits = (360.0, 2) if is_deg else (2.0 * np.pi, 4)
        self.angle_factor = self.sign * 360.0 / full
        yaw = self.angle_deg / self.angle_factor + rng.uniform(-0.5, 0.5) * full + self.noise(2e-5 * full)
        low = float(rng.choice([0.0, -0.5])) * full
        self.places["angle"] = len(self.labels)
        self.add("yaw", (yaw - low) % full + low, digits)
        for name in ("pitch", "roll"):
            tilt = rng.normal(0, 0.05) + 0.02 * np.sin(5.0 * self.t_s) * self.is_moving + self.noise(1e-4)
            self.add(name, tilt * full / (2.0 * np.pi), digits)

    def acc(self) -> None:
        """Gravity, and what a turn at the end of an arm adds."""
        rng = self.rng
        per_g, digits = PER_G[str(rng.choice(list(PER_G)))]
        omega, arm_m = np.radians(self.rate_dps), float(rng.choice([0.0, 0.02, 0.3]))
        push = (omega**2 * arm_m / 9.8, np.gradient(omega, self.t_s) * arm_m / 9.8, 0.0 * self.t_s)
        for axis, name in enumerate("xyz"):
            g = float(axis == self.vertical) + 0.03 * rng.normal() + push[(axis - self.vertical + 2) % 3]
            self.add(f"a{name}", (g + self.noise(0.003)) * per_g, digits)

    def temp(self) -> None:
        self.add("temp", 27.0 + 0.02 * self.t_s + self.noise(0.02), 2)

    def mag(self) -> None:
        towards = np.radians(self.angle_deg + self.rng.uniform(0, 360))
        for name, share in (("x", np.cos(towards)), ("y", np.sin(towards)), ("z", 0.0 * towards - 1.8)):
            self.add(f"m{name}", 24.0 * share + self.noise(0.4), 1)


def random_board(seed: int) -> TurnedBoard:
    """Columns, units, order, form, bias, noise, wobble and delays by the seed."""
    rng = np.random.default_rng(seed)
    maker = _Maker(rng)
    chances = {"gyro": 0.85, "angles": 0.35, "acc": 0.6, "temp": 0.25, "mag": 0.25}
    groups = [name for name, chance in chances.items() if rng.random() < chance] or ["acc"]
    rng.shuffle(groups)
    if rng.random() < 0.7:
        maker.clock()
    for group in groups:
        getattr(maker, group)()
    form = str(rng.choice([*MARKS, "colon", "equals", "json"]))
    named = rng.random() < 0.7
    labels = maker.labels if named else [f"v{chr(97 + index)}" for index in range(len(maker.labels))]
    t_s = maker.t_s
    lines = [_line(form, labels, [column[index] for column in maker.texts]) for index in range(len(t_s))]
    about = f"{maker.about}, {groups}, {form}: {lines[-1]}"
    if form in MARKS and rng.random() < 0.3:
        lines.insert(0, MARKS[form].join(labels))
        t_s = np.concatenate([[0.0], t_s])
    late_s = np.maximum.accumulate(t_s + rng.exponential(float(rng.choice([0.0, 0.002, 0.01])), len(t_s)))
    position = {key: index if form in MARKS else labels[index] for key, index in maker.places.items()}
    return TurnedBoard(
        [TimedLine(100.0 + float(when), text) for when, text in zip(late_s, lines, strict=True)],
        TurnWindow(100.0, 100.0 + REST_S, 100.0 + float(late_s[-1])),
        (position["rate"], maker.sign / PER_DPS[maker.unit]) if "rate" in position else None,
        (position["angle"], maker.angle_factor) if "angle" in position else None,
        about,
    )


def _line(form: str, labels: list[str], texts: list[str]) -> str:
    if form in MARKS:
        return MARKS[form].join(texts)
    if form == "json":
        return json.dumps({label: float(text) for label, text in zip(labels, texts, strict=True)})
    mark, apart = (":", "\t") if form == "colon" else ("=", ", ")
    return apart.join(f"{label}{mark}{text}" for label, text in zip(labels, texts, strict=True))
