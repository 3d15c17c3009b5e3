"""Likely units of a rate by its noise, turns, bias, whole numbers and encoder, against the unit it is read in.

A stream does not prove its unit, but cheap gyros have similar noise and are turned at similar rates. Read as deg/s, a
rate in rad/s would be too quiet and too slow. Every feature gives a likelihood ratio; their product with PRIOR gives
the odds. All distributions have heavy tails (Student's t), so that no single feature decides.

The centers come from recordings of nine kinds of sensors: noise at rest of 0.03 to 0.4 deg/s, turns of 40 to 350 deg/s.
The scales are wider than measured, because nine are few.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from math import degrees, isfinite, isnan, log, nan, radians, sqrt
from statistics import median

from gyrodrift.columns.sizes import SENSITIVITIES
from gyrodrift.values.constants import FULL_TURN_DEG
from gyrodrift.values.sample import Sample

PRIOR = 0.05
"""Prior share of streams in another unit than deg/s; a guess."""

SURE_ODDS = 100.0
"""Odds from which a unit is reported; the highest odds of 95 recordings in deg/s are far below."""

ODDS_MAX = 1e6
"""Largest reported odds: the model is not more accurate."""

WINDOWS_MIN = 5
QUIET_SHARE, QUIET_WINDOWS = 0.2, 10
"""Share of the quietest windows that give the noise at rest, and their largest number: a turntable may rest once."""

DEGREES_OF_FREEDOM = 5.0
NOISE_DPS, NOISE_SCALE = 0.08, log(2.5)
TURN_DPS, TURN_SCALE = 80.0, log(3.0)
BIAS_DPS, BIAS_DEGREES_OF_FREEDOM = 3.0, 2.0
BEYOND = ((4400.0, 0.02), (2200.0, 0.15))
"""Shares of devices that measure more than these rates, deg/s; guesses.

Ranges of cheap gyros are 2000 deg/s, and 4000 of ICM-42686, ICM-45686 and LSM6DSV, plus 10 %.
"""

ENCODER_SCALE = 0.1
"""Relative error of the scale of a gyro, wider than in data sheets."""

SAME_AXIS = 0.9
"""Squared correlation from which encoder and rates have the same axis."""

TURN_NOISES = 20.0
"""Smallest turn, in multiples of the noise."""

ENCODER_MIN_DEG = 45.0
ENCODER_STEP_DEG = 120.0
"""Larger steps of an encoder between two samples may have lost a turn."""

DISTINCT_MAX = 1000
"""Largest number of distinct values that are kept for their step."""

DIGITS = 1e-9
"""Smallest step relative to the largest number; smaller differences are rounding errors."""

WHOLE_DISTINCT = 8
"""Distinct whole numbers from which on they are no coincidence."""

REST_LEVEL, LOG_TURN = 0.354, 0.380 / TURN_SCALE
"""Largest densities of a bias over its scale, and of the logarithm of a turn: Student's t with 2 and 5 degrees."""

ZEROED_SHARE = 0.1
"""Share of streams without a bias, because the device subtracts it at the start; a guess."""

SPINS_SHARE, SPIN_NOISE, SPIN_SCALE = 0.03, 0.003, log(5.0)
"""Share of streams whose quietest windows are in a rotation, and the noise of a rotation as a share of its rate.

A turntable may never rest. Its noise says nothing about the unit. All three are guesses.
"""

DEGREES_PER_S = "deg/s"
RADIANS = "rad/s"
DEGREES = "deg/s taken for rad/s"
MILLIDEGREES = "mdps"
TENTHS = "0.1 deg/s"
REVOLUTIONS = "rev/s"
REVOLUTIONS_PER_MIN = "rpm"
COUNTS = "counts"


@dataclass(frozen=True, slots=True)
class _Unit:
    """Unit of a rate: `per_dps` units per deg/s, its weight, and the share of devices that send whole numbers in it."""

    name: str
    per_dps: float
    entry: str
    weight: float = 1.0
    whole: float = 0.02


UNITS = (
    _Unit(RADIANS, radians(1.0), "rads"),
    _Unit(DEGREES, degrees(1.0), "lsb/57.3", weight=0.2),
    _Unit(MILLIDEGREES, 1000.0, "mdps", whole=0.5),
    _Unit(TENTHS, 10.0, "lsb/10", weight=0.1, whole=0.5),
    _Unit(REVOLUTIONS, 1.0 / 360.0, "lsb/0.00277778", weight=0.02),
    _Unit(REVOLUTIONS_PER_MIN, 1.0 / 6.0, "lsb/0.166667", weight=0.02),
    *(_Unit(COUNTS, per, f"lsb/{per:g}", 1.0 / len(SENSITIVITIES), whole=1.0) for per in SENSITIVITIES),
)
"""Units besides deg/s. Weights and shares of whole numbers are guesses; fractions are never counts."""

PER_DPS = {unit.name: unit.per_dps for unit in UNITS if unit.name != COUNTS}
"""Units per deg/s; if deg/s were taken for rad/s, all numbers are multiplied by 57.3."""

LIKELY_SHARE = 0.01
"""Units are named that are this likely, compared with the likeliest."""

DELTA_FACTOR = 3.0
"""Factor within which noise and turns do not tell a unit from the angle of each sample."""

SAME_UNIT = 0.05
"""Relative difference of two scales that are one unit; sensitivities in data sheets differ by more."""

HELD_SHARE = 0.05
"""Share of devices whose firmware sets small rates to zero, and so hides the noise; a guess."""


@dataclass(frozen=True, slots=True)
class RateUnit:
    """Unit other than the one that the rates are read in.

    unit
        Its name: RADIANS, COUNTS and others.
    odds
        Odds of this unit against the one that is read, to one.
    per_dps
        Units per deg/s; for counts the best sensitivity.
    noise, turn
        Noise, and largest turn, in deg/s as read; 0 without a turn.
    entry
        Unit in a SPEC, such as `rads` or `lsb/131`.
    """

    unit: str
    odds: float
    per_dps: float
    noise: float
    turn: float
    entry: str

    @property
    def evidence(self) -> str:
        """Noise and turn as they are read, and as they usually are."""
        turn = f", and turns reach {self.turn:.3g}, usual is {TURN_DPS:g}" if self.turn else ""
        return f"in deg/s, the noise at rest would be {self.noise:.2g}, usual is {NOISE_DPS:g}{turn}"


def compared(likely: Sequence[RateUnit]) -> str:
    """Likely units with their shares: `mdps (rate:mdps) 60 %, counts (rate:lsb/131) 40 %`."""
    total = sum(unit.odds for unit in likely)
    shares = ((unit, 100.0 * unit.odds / total) for unit in likely)
    return ", ".join(f"{unit.unit} (rate:{unit.entry}) {share:.2g} %" for unit, share in shares)


def event_fields(
    likely: Sequence[RateUnit], protocol: str, columns: str, port: str, period_s: float
) -> Mapping[str, object]:
    """Fields of the event that reports likely units, with advice.

    `columns` is the SPEC of the lines, with `{}` for the unit. The angle since the last line is the rate times
    `period_s`, which may be near the scale of a unit: 1/50 is near π/180.
    """
    best = likely[0]
    hint = {
        "csv": "read it with --columns " + " or ".join(f"'{columns.format(unit.entry)}'" for unit in likely),
        "text": "in --columns, write " + " or ".join(f"rate:{unit.entry}" for unit in likely),
    }.get(protocol, "the scale of the device does not fit its rates")
    if protocol in {"csv", "text"}:
        hint += ", with N of lsb/N from the data sheet of your sensor" if best.unit == COUNTS else ""
        if any(1.0 / DELTA_FACTOR < unit.per_dps / period_s < DELTA_FACTOR for unit in likely):
            hint += "; if it is the angle since the last line, call it delta:deg or delta:rad, not rate"
        hint += f"; a quarter turn proves it: gyrodrift doctor --port {port} --turn"
    return {
        "unit": best.unit,
        "odds": f"{min(best.odds, ODDS_MAX):.0f} to 1",
        **({"likely": compared(likely)} if len(likely) > 1 else {}),
        "reason": best.evidence,
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
    """Odds of other units for a stream.

    scale
        Deg/s per unit in which the stream is read; its samples are in deg/s.
    """

    scale: float = 1.0
    _windows: list[_Window] = field(default_factory=list)
    _distinct: set[float] = field(default_factory=set)
    _is_whole: bool = True

    def take(self, samples: Sequence[Sample]) -> None:
        """Add the samples of a window, which are consecutive."""
        if not all(isfinite(sample.rate_dps) for sample in samples):
            return
        rates = [sample.rate_dps / self.scale for sample in samples]
        bends = [a - 2.0 * b + c for a, b, c in zip(rates, rates[1:], rates[2:], strict=False)]
        noise = sqrt(sum(bend * bend for bend in bends) / len(bends) / 6.0)  # 1 + 4 + 1: variance for white noise
        turns = [_wrapped(b.encoder_deg - a.encoder_deg) for a, b in pairwise(samples)]
        encoder_deg = sum(turns) if max(map(abs, turns)) < ENCODER_STEP_DEG else nan
        times_s = [sample.t_device_s for sample in samples]
        angle = sum(0.5 * (a + b) * (d - c) for (a, b), (c, d) in zip(pairwise(rates), pairwise(times_s), strict=True))
        self._windows.append(_Window(noise, median(rates), times_s[-1] - times_s[0], angle, encoder_deg))
        self._is_whole = self._is_whole and all(abs(rate - round(rate)) <= DIGITS * abs(rate) for rate in rates)
        if len(self._distinct) < DISTINCT_MAX:
            self._distinct.update(rates)

    def sure(self) -> list[RateUnit]:
        """Likely units if the odds of the likeliest reach SURE_ODDS; else empty."""
        likely = self.likely()
        return likely if likely and likely[0].odds >= SURE_ODDS else []

    def likely(self) -> list[RateUnit]:
        """Other units in the order of their odds, within LIKELY_SHARE of the first.

        Empty with too few windows, or if all numbers are equal. If rounding, or firmware that sets small rates to zero,
        hides the noise, the rounding error replaces it.
        """
        noisy = [window for window in self._windows if window.noise > 0.0]
        zero_windows = sum(window.noise == window.level == 0.0 for window in self._windows)
        is_hidden = len(noisy) < WINDOWS_MIN <= len(self._windows) or zero_windows >= WINDOWS_MIN
        windows = self._windows if is_hidden else noisy
        hidden = self._step() / sqrt(12.0)
        if len(windows) < WINDOWS_MIN or (is_hidden and not hidden):
            return []
        noises = sorted(max(window.noise, hidden) for window in windows)
        noise = noises[min(int(QUIET_SHARE * len(noises)), QUIET_WINDOWS - 1)]
        bias = median(window.level for window in self._windows if window.noise <= 1.5 * noise)
        turn = max(abs(window.level - bias) for window in self._windows)
        turn = turn if turn > TURN_NOISES * noise else 0.0
        fastest = max(abs(window.level) for window in self._windows)
        features = _Features(noise, is_hidden, turn, bias, fastest, self._scale_by_encoder(bias))
        return self._compared(features)

    def _compared(self, features: "_Features") -> list[RateUnit]:
        scale = abs(self.scale)
        own = next((unit for unit in UNITS if _is_same(unit.per_dps * scale)), _Unit(DEGREES_PER_S, 1.0 / scale, ""))
        as_read = _likelihood(scale, features) * self._share_whole(own) / PRIOR
        fits: dict[str, list[tuple[float, _Unit]]] = {}
        for unit in UNITS:
            if not _is_same(unit.per_dps * scale):
                likelihood = unit.weight * _likelihood(1.0 / unit.per_dps, features) * self._share_whole(unit)
                fits.setdefault(unit.name, []).append((likelihood, unit))
        units = []
        for name, of_name in fits.items():
            best = max(of_name, key=lambda fit: fit[0])[1]
            odds = sum(likelihood for likelihood, _ in of_name) / as_read
            noise, turn = features.noise * scale, features.turn * scale
            units.append(RateUnit(name, odds, best.per_dps, noise, turn, best.entry))
        units.sort(key=lambda unit: -unit.odds)
        return [unit for unit in units if unit.odds >= LIKELY_SHARE * units[0].odds > 0.0]

    def _share_whole(self, unit: _Unit) -> float:
        """Share of devices with this unit that send whole numbers, or not, as this stream; few numbers show neither."""
        if not self._is_whole:
            return 1.0 - unit.whole
        if len(self._distinct) < WHOLE_DISTINCT:
            return 0.0 if unit.name == COUNTS else 1.0
        return unit.whole

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
    """Features of a stream, in its own numbers; `scale` is degrees of the encoder per degree of the rates.

    `turn` is the largest difference to `bias`, the level of the quietest windows, and `fastest` to 0.
    """

    noise: float
    is_hidden: bool
    turn: float
    bias: float
    fastest: float
    scale: float | None


def _wrapped(step_deg: float) -> float:
    """Step of an angle that may wrap, deg."""
    return (step_deg + 0.5 * FULL_TURN_DEG) % FULL_TURN_DEG - 0.5 * FULL_TURN_DEG


def _is_same(factor: float) -> bool:
    return abs(factor - 1.0) < SAME_UNIT


def _likelihood(dps: float, features: _Features) -> float:
    """Likelihood of the features up to a constant factor, for a unit of `dps` deg/s."""
    noise, bias = features.noise, features.bias
    rest = student(log(noise * dps / NOISE_DPS) / NOISE_SCALE, DEGREES_OF_FREEDOM)
    if features.is_hidden:
        rest = HELD_SHARE + (1.0 - HELD_SHARE) * rest
    biased, zeroed = (student(bias / size, BIAS_DEGREES_OF_FREEDOM) / size for size in (BIAS_DPS / dps, noise))
    rest *= REST_LEVEL * ((1.0 - ZEROED_SHARE) * biased + ZEROED_SHARE * zeroed)
    rest *= _turn(features.turn * dps) if features.turn else 1.0
    product = (1.0 - SPINS_SHARE) * rest
    if features.fastest:
        z = log(noise / (SPIN_NOISE * features.fastest)) / SPIN_SCALE
        spin = student(z, DEGREES_OF_FREEDOM) * NOISE_SCALE / SPIN_SCALE
        product += SPINS_SHARE * spin * LOG_TURN / features.fastest * _turn(features.fastest * dps)
    if features.scale is not None:
        product *= student(log(features.scale / dps) / ENCODER_SCALE, DEGREES_OF_FREEDOM)
    return product


def _turn(dps: float) -> float:
    """Density of the rate of a turn, without its constant."""
    density = student(log(dps / TURN_DPS) / TURN_SCALE, DEGREES_OF_FREEDOM)
    return density * next((share for range_dps, share in BEYOND if dps > range_dps), 1.0)


def student(z: float, degrees_of_freedom: float) -> float:
    """Density of Student's t without its constant."""
    return float((1.0 + z * z / degrees_of_freedom) ** (-0.5 * (degrees_of_freedom + 1.0)))
