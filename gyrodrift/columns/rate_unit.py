"""Rates in rad/s or in counts, taken for deg/s: found from noise at rest, turns, bias and whole numbers.

A stream says nothing of its unit, but cheap gyros are alike, and so is what they are turned by: as deg/s, the rest
noise of one in rad/s would be that of no such sensor, and its turns those of a telescope. Each feature gives a ratio of
likelihoods; they are multiplied, with PRIOR, to odds. The tails of all distributions are heavy (Student's t), so that
no single feature decides.

The centres are those of recordings of nine kinds of sensor: noise at rest of 0.03 to 0.4 deg/s, turns of 40 to 350
deg/s. The scales are wider than they are, for nine are few.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from math import degrees, isfinite, isnan, log, radians, sqrt
from statistics import median

from gyrodrift.sample import Sample

PRIOR = 0.05
"""Share of streams in another unit than deg/s, before anything is seen of one; a guess."""

SURE_ODDS = 100.0
"""From here on a unit is named; the highest odds that any of 95 recordings in deg/s reaches are far below."""

MOST_ODDS = 1e6
"""What is told at most: the model is not true to more than that."""

WINDOW = 50
"""Samples from which noise and level are taken."""

WINDOWS_LEAST = 5
QUIET_SHARE = 0.2
"""Noise at rest is that of the quietest fifth of the windows."""

DEGREES_OF_FREEDOM = 5.0
NOISE_DPS, NOISE_SCALE = 0.08, log(2.5)
TURN_DPS, TURN_SCALE = 80.0, log(3.0)
BIAS_DPS, BIAS_DEGREES_OF_FREEDOM = 3.0, 2.0
RANGE_DPS, BEYOND_SHARE = 2200.0, 0.02
"""The largest range of cheap gyros, 2000 deg/s, and a little more (data sheets of InvenSense, Bosch and ST), and the
share of devices that measure beyond it; a guess."""

ENCODER_SCALE = 0.1
"""Relative error of a gyro's scale, generously."""

ALIKE = 0.9
"""Square of the correlation of encoder and rates from which on they are said to be of one axis."""

TURN_NOISES = 20.0
"""A turn stands out of the noise by so much."""

ENCODER_LEAST_DEG = 45.0

MOST_DISTINCT = 1000
"""Different numbers that are kept: more tell nothing of their step."""

DIGITS = 1e-9
"""Of the largest number: closer ones differ by how they were calculated."""

WHOLE_DISTINCT = 8
WHOLE_SHARE = 0.02
"""Share of devices in deg/s that say whole numbers only."""

SENSITIVITIES = (131.0, 65.5, 32.8, 16.4, 114.3, 57.1, 28.6, 14.3)
"""Counts per deg/s: InvenSense and Bosch at ±250 to 2000 deg/s, ST at 8.75 to 70 mdps a count (data sheets)."""

RADIANS = "rad/s"
DEGREES = "deg/s taken for rad/s"
MILLIDEGREES = "mdps"
COUNTS = "counts"

PER_DPS = {RADIANS: radians(1.0), DEGREES: degrees(1.0), MILLIDEGREES: 1000.0}
"""How many of a unit are one deg/s; where deg/s were taken for rad/s, all numbers are multiplied by 57.3."""

HELD_SHARE = 0.05
"""Share of devices whose firmware holds small rates at zero, and so shows no noise whatever the sensor; a guess."""


@dataclass(frozen=True, slots=True)
class RateUnit:
    """A unit that fits better than deg/s.

    unit
        RADIANS, DEGREES, MILLIDEGREES or COUNTS.
    odds
        Of this unit against deg/s, to one.
    per_dps
        How many of it are one deg/s; of counts the sensitivity that fits best.
    noise, turn
        What was seen, in the numbers of the stream; 0 where nothing turned.
    """

    unit: str
    odds: float
    per_dps: float
    noise: float
    turn: float


def says(found: RateUnit, protocol: str) -> Mapping[str, object]:
    """Fields of the event that names a unit, with what to do."""
    seen = f"at rest it scatters by {found.noise:.2g}"
    if found.turn:
        seen += f", and turns reach {found.turn:.3g}"
    is_counts = found.unit == COUNTS
    entry = {RADIANS: "rate:rads", DEGREES: "rate:dps", MILLIDEGREES: "rate:mdps"}.get(
        found.unit, f"rate:lsb/{found.per_dps:g}"
    )
    hint = {
        "csv": f"--columns 't_us, {entry}' reads it so",
        "text": f"in --columns, write {entry}",
    }.get(protocol, "the scale that the device states, or has, is not that of its rates")
    if is_counts and protocol in {"csv", "text"}:
        hint += ", with N of lsb/N from the data sheet of your sensor"
    return {
        "unit": found.unit,
        "odds": f"{min(found.odds, MOST_ODDS):.0f} to 1",
        "reason": f"taken for deg/s, {seen}; that of usual gyros is {NOISE_DPS:g} and {TURN_DPS:g}",
        "hint": hint,
    }


@dataclass(frozen=True, slots=True)
class _Window:
    """Some samples one after the other: noise without what moves slowly, middle rate, sum of the rates over time.

    `encoder_deg` is how far the encoder went meanwhile; NaN without one.
    """

    noise: float
    level: float
    seconds: float
    turned: float
    encoder_deg: float


@dataclass(slots=True)
class RateUnitOdds:
    """Takes windows of samples of a stream that is believed to be in deg/s, and weighs the other units."""

    _windows: list[_Window] = field(default_factory=list)
    _distinct: set[float] = field(default_factory=set)
    _is_whole: bool = True

    def take(self, samples: Sequence[Sample]) -> None:
        """Take WINDOW samples that follow each other."""
        rates = [sample.rate_dps for sample in samples]
        if not all(map(isfinite, rates)):
            return
        bends = [a - 2.0 * b + c for a, b, c in zip(rates, rates[1:], rates[2:], strict=False)]
        noise = sqrt(sum(bend * bend for bend in bends) / len(bends) / 6.0)  # 1 + 4 + 1: of white noise
        encoder_deg = samples[-1].encoder_deg - samples[0].encoder_deg
        seconds = samples[-1].t_device_s - samples[0].t_device_s
        turned = sum(0.5 * (a.rate_dps + b.rate_dps) * (b.t_device_s - a.t_device_s) for a, b in pairwise(samples))
        self._windows.append(_Window(noise, median(rates), seconds, turned, encoder_deg))
        self._is_whole = self._is_whole and all(rate == round(rate) for rate in rates)
        if len(self._distinct) < MOST_DISTINCT:
            self._distinct.update(rates)

    def verdict(self) -> RateUnit | None:
        """The unit that fits best, where its odds are high enough to name it."""
        best = self.best()
        return best if best is not None and best.odds >= SURE_ODDS else None

    def best(self) -> RateUnit | None:
        """The best one of the other units; None before there are windows enough, or where all numbers are the same.

        Where rounding, or firmware that holds small rates, hides the noise, it is no more than the error of a step.
        """
        noisy = [window for window in self._windows if window.noise > 0.0]
        is_hidden = len(noisy) < WINDOWS_LEAST
        windows = self._windows if is_hidden else noisy
        hidden = self._step() / sqrt(12.0)
        if len(windows) < WINDOWS_LEAST or (is_hidden and not hidden):
            return None
        noises = sorted(max(window.noise, hidden) for window in windows)
        noise = noises[int(QUIET_SHARE * len(noises))]
        bias = median(window.level for window in self._windows if window.noise <= 1.5 * noise)
        turn = max(abs(window.level - bias) for window in self._windows)
        turn = turn if turn > TURN_NOISES * noise else 0.0
        seen = _Seen(noise, is_hidden, turn, bias, self._scale_by_encoder(bias))
        as_dps = _likelihood(1.0, seen)
        found = [RateUnit(unit, _likelihood(1.0 / per, seen), per, noise, turn) for unit, per in PER_DPS.items()]
        if self._is_whole and len(self._distinct) >= WHOLE_DISTINCT:
            each = [(_likelihood(1.0 / per, seen), per) for per in SENSITIVITIES]
            likelihood = sum(value for value, _ in each) / len(each) / WHOLE_SHARE
            found.append(RateUnit(COUNTS, likelihood, max(each)[1], noise, turn))
        best = max(found, key=lambda unit: unit.odds)
        return replace(best, odds=best.odds / as_dps * PRIOR)

    def _step(self) -> float:
        """The smallest distance of two different numbers, 0 being one of them; 0 where all are 0."""
        numbers = sorted(self._distinct | {0.0})
        least = DIGITS * max(map(abs, numbers), default=0.0)
        return min((b - a for a, b in pairwise(numbers) if b - a > least), default=0.0)

    def _scale_by_encoder(self, bias: float) -> float | None:
        """Degrees of the encoder for one degree of the rates; None without an encoder that turns as they do."""
        seen = [window for window in self._windows if not isnan(window.encoder_deg)]
        pairs = [(window.turned - bias * window.seconds, window.encoder_deg) for window in seen]
        of_rates = sum(by_rate * by_rate for by_rate, _ in pairs)
        of_encoder = sum(by_encoder * by_encoder for _, by_encoder in pairs)
        together = sum(by_rate * by_encoder for by_rate, by_encoder in pairs)
        if sum(abs(by_encoder) for _, by_encoder in pairs) < ENCODER_LEAST_DEG:
            return None
        return abs(together) / of_rates if together * together > ALIKE * of_rates * of_encoder else None


@dataclass(frozen=True, slots=True)
class _Seen:
    """What was seen of a stream, in its own numbers; `scale` is degrees of the encoder for one of the rates."""

    noise: float
    is_hidden: bool
    turn: float
    bias: float
    scale: float | None


def _likelihood(dps: float, seen: _Seen) -> float:
    """Of what was seen, up to a factor that is the same for all units, where one of the unit is `dps` deg/s."""
    product = student(log(seen.noise * dps / NOISE_DPS) / NOISE_SCALE, DEGREES_OF_FREEDOM)
    if seen.is_hidden:
        product = HELD_SHARE + (1.0 - HELD_SHARE) * product
    product *= dps * student(seen.bias * dps / BIAS_DPS, BIAS_DEGREES_OF_FREEDOM)
    if seen.turn:
        product *= student(log(seen.turn * dps / TURN_DPS) / TURN_SCALE, DEGREES_OF_FREEDOM)
        product *= BEYOND_SHARE if seen.turn * dps > RANGE_DPS else 1.0
    if seen.scale is not None:
        product *= student(log(seen.scale / dps) / ENCODER_SCALE, DEGREES_OF_FREEDOM)
    return product


def student(z: float, degrees_of_freedom: float) -> float:
    """Density of Student's t, up to its constant."""
    return float((1.0 + z * z / degrees_of_freedom) ** (-0.5 * (degrees_of_freedom + 1.0)))
