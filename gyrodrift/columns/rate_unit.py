"""Detection of rates in rad/s or counts that are taken for deg/s, from noise, turns, bias and whole numbers.

A stream does not state its unit, but cheap gyros have similar noise and are turned at similar rates. Read as deg/s, a
rate in rad/s would be too quiet and too slow. Every feature gives a likelihood ratio; their product with PRIOR gives
the odds. All distributions have heavy tails (Student's t), so that no single feature decides.

The centers come from recordings of nine kinds of sensors: noise at rest of 0.03 to 0.4 deg/s, turns of 40 to 350 deg/s.
The scales are wider than measured, because nine are few.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from math import degrees, isfinite, isnan, log, radians, sqrt
from statistics import median

from gyrodrift.columns.sizes import SENSITIVITIES
from gyrodrift.values.sample import Sample

PRIOR = 0.05
"""Prior share of streams in another unit than deg/s; a guess."""

SURE_ODDS = 100.0
"""Odds from which a unit is reported; the highest odds of 95 recordings in deg/s are far below."""

ODDS_MAX = 1e6
"""Largest reported odds: the model is not more accurate."""

WINDOW = 50
"""Samples per window, for noise and level."""

WINDOWS_MIN = 5
QUIET_SHARE = 0.2
"""Share of the quietest windows that give the noise at rest."""

DEGREES_OF_FREEDOM = 5.0
NOISE_DPS, NOISE_SCALE = 0.08, log(2.5)
TURN_DPS, TURN_SCALE = 80.0, log(3.0)
BIAS_DPS, BIAS_DEGREES_OF_FREEDOM = 3.0, 2.0
RANGE_DPS, BEYOND_SHARE = 2200.0, 0.02
"""Range of cheap gyros, 2000 deg/s plus 10 % (data sheets of InvenSense, Bosch and ST).

The share of devices that measure more is a guess.
"""

ENCODER_SCALE = 0.1
"""Relative error of the scale of a gyro, wider than in data sheets."""

SAME_AXIS = 0.9
"""Squared correlation from which encoder and rates have the same axis."""

TURN_NOISES = 20.0
"""Smallest turn, in multiples of the noise."""

ENCODER_MIN_DEG = 45.0

DISTINCT_MAX = 1000
"""Largest number of distinct values that are kept for their step."""

DIGITS = 1e-9
"""Smallest step relative to the largest number; smaller differences are rounding errors."""

WHOLE_DISTINCT = 8
WHOLE_SHARE = 0.02
"""Share of devices in deg/s that send whole numbers only."""

RADIANS = "rad/s"
DEGREES = "deg/s taken for rad/s"
MILLIDEGREES = "mdps"
COUNTS = "counts"

PER_DPS = {RADIANS: radians(1.0), DEGREES: degrees(1.0), MILLIDEGREES: 1000.0}
"""Units per deg/s; if deg/s were taken for rad/s, all numbers are multiplied by 57.3."""

HELD_SHARE = 0.05
"""Share of devices whose firmware sets small rates to zero, and so hides the noise; a guess."""


@dataclass(frozen=True, slots=True)
class RateUnit:
    """Unit that fits better than deg/s.

    unit
        RADIANS, DEGREES, MILLIDEGREES or COUNTS.
    odds
        Odds of this unit against deg/s, to one.
    per_dps
        Units per deg/s; for counts the best sensitivity.
    noise, turn
        Noise, and largest turn, in the numbers of the stream; 0 without a turn.
    """

    unit: str
    odds: float
    per_dps: float
    noise: float
    turn: float


def event_fields(rate_unit: RateUnit, protocol: str) -> Mapping[str, object]:
    """Fields of the event that reports a unit, with advice."""
    measured = f"the noise at rest would be {rate_unit.noise:.2g}"
    if rate_unit.turn:
        measured += f", and the fastest turn {rate_unit.turn:.3g}"
    is_counts = rate_unit.unit == COUNTS
    entry = {RADIANS: "rate:rads", DEGREES: "rate:dps", MILLIDEGREES: "rate:mdps"}.get(
        rate_unit.unit, f"rate:lsb/{rate_unit.per_dps:g}"
    )
    hint = {
        "csv": f"read it with --columns 't_us, {entry}'",
        "text": f"in --columns, write {entry}",
    }.get(protocol, "the scale of the device does not fit its rates")
    if is_counts and protocol in {"csv", "text"}:
        hint += ", with N of lsb/N from the data sheet of your sensor"
    return {
        "unit": rate_unit.unit,
        "odds": f"{min(rate_unit.odds, ODDS_MAX):.0f} to 1",
        "reason": f"in deg/s, {measured}; usual are {NOISE_DPS:g} and {TURN_DPS:g}",
        "hint": hint,
    }


@dataclass(frozen=True, slots=True)
class _Window:
    """Window of samples: noise without slow motion, median rate, integral of the rates.

    `encoder_deg` is the change of the encoder; NaN without one.
    """

    noise: float
    level: float
    seconds: float
    angle: float
    encoder_deg: float


@dataclass(slots=True)
class RateUnitOdds:
    """Odds of other units for a stream that is taken for deg/s."""

    _windows: list[_Window] = field(default_factory=list)
    _distinct: set[float] = field(default_factory=set)
    _is_whole: bool = True

    def take(self, samples: Sequence[Sample]) -> None:
        """Add WINDOW consecutive samples."""
        rates = [sample.rate_dps for sample in samples]
        if not all(map(isfinite, rates)):
            return
        bends = [a - 2.0 * b + c for a, b, c in zip(rates, rates[1:], rates[2:], strict=False)]
        noise = sqrt(sum(bend * bend for bend in bends) / len(bends) / 6.0)  # 1 + 4 + 1: variance for white noise
        encoder_deg = samples[-1].encoder_deg - samples[0].encoder_deg
        seconds = samples[-1].t_device_s - samples[0].t_device_s
        angle = sum(0.5 * (a.rate_dps + b.rate_dps) * (b.t_device_s - a.t_device_s) for a, b in pairwise(samples))
        self._windows.append(_Window(noise, median(rates), seconds, angle, encoder_deg))
        self._is_whole = self._is_whole and all(rate == round(rate) for rate in rates)
        if len(self._distinct) < DISTINCT_MAX:
            self._distinct.update(rates)

    def verdict(self) -> RateUnit | None:
        """Best unit if its odds reach SURE_ODDS, else None."""
        best = self.best()
        return best if best is not None and best.odds >= SURE_ODDS else None

    def best(self) -> RateUnit | None:
        """Best of the other units; None with too few windows, or if all numbers are equal.

        If rounding, or firmware that sets small rates to zero, hides the noise, the rounding error replaces it.
        """
        noisy = [window for window in self._windows if window.noise > 0.0]
        is_hidden = len(noisy) < WINDOWS_MIN
        windows = self._windows if is_hidden else noisy
        hidden = self._step() / sqrt(12.0)
        if len(windows) < WINDOWS_MIN or (is_hidden and not hidden):
            return None
        noises = sorted(max(window.noise, hidden) for window in windows)
        noise = noises[int(QUIET_SHARE * len(noises))]
        bias = median(window.level for window in self._windows if window.noise <= 1.5 * noise)
        turn = max(abs(window.level - bias) for window in self._windows)
        turn = turn if turn > TURN_NOISES * noise else 0.0
        features = _Features(noise, is_hidden, turn, bias, self._scale_by_encoder(bias))
        as_dps = _likelihood(1.0, features)
        units = [RateUnit(unit, _likelihood(1.0 / per, features), per, noise, turn) for unit, per in PER_DPS.items()]
        if self._is_whole and len(self._distinct) >= WHOLE_DISTINCT:
            fits = [(_likelihood(1.0 / per, features), per) for per in SENSITIVITIES]
            likelihood = sum(value for value, _ in fits) / len(fits) / WHOLE_SHARE
            units.append(RateUnit(COUNTS, likelihood, max(fits)[1], noise, turn))
        best = max(units, key=lambda unit: unit.odds)
        return replace(best, odds=best.odds / as_dps * PRIOR)

    def _step(self) -> float:
        """Smallest difference of two distinct numbers, including 0; 0 if all are 0."""
        numbers = sorted(self._distinct | {0.0})
        smallest = DIGITS * max(map(abs, numbers), default=0.0)
        return min((b - a for a, b in pairwise(numbers) if b - a > smallest), default=0.0)

    def _scale_by_encoder(self, bias: float) -> float | None:
        """Degrees of the encoder per degree of the rates; None without an encoder of the same axis."""
        windows = [window for window in self._windows if not isnan(window.encoder_deg)]
        pairs = [(window.angle - bias * window.seconds, window.encoder_deg) for window in windows]
        of_rates = sum(by_rate * by_rate for by_rate, _ in pairs)
        of_encoder = sum(by_encoder * by_encoder for _, by_encoder in pairs)
        together = sum(by_rate * by_encoder for by_rate, by_encoder in pairs)
        if sum(abs(by_encoder) for _, by_encoder in pairs) < ENCODER_MIN_DEG:
            return None
        return abs(together) / of_rates if together * together > SAME_AXIS * of_rates * of_encoder else None


@dataclass(frozen=True, slots=True)
class _Features:
    """Features of a stream, in its own numbers; `scale` is degrees of the encoder per degree of the rates."""

    noise: float
    is_hidden: bool
    turn: float
    bias: float
    scale: float | None


def _likelihood(dps: float, features: _Features) -> float:
    """Likelihood of the features up to a constant factor, for a unit of `dps` deg/s."""
    product = student(log(features.noise * dps / NOISE_DPS) / NOISE_SCALE, DEGREES_OF_FREEDOM)
    if features.is_hidden:
        product = HELD_SHARE + (1.0 - HELD_SHARE) * product
    product *= dps * student(features.bias * dps / BIAS_DPS, BIAS_DEGREES_OF_FREEDOM)
    if features.turn:
        product *= student(log(features.turn * dps / TURN_DPS) / TURN_SCALE, DEGREES_OF_FREEDOM)
        product *= BEYOND_SHARE if features.turn * dps > RANGE_DPS else 1.0
    if features.scale is not None:
        product *= student(log(features.scale / dps) / ENCODER_SCALE, DEGREES_OF_FREEDOM)
    return product


def student(z: float, degrees_of_freedom: float) -> float:
    """Density of Student's t without its constant."""
    return float((1.0 + z * z / degrees_of_freedom) ** (-0.5 * (degrees_of_freedom + 1.0)))
