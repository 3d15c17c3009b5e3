"""Check before a diagnosis, without a simulation: what recordings can show, and what to record instead.

The rate error of each second is regressed on the term of an effect, such as the rate for a scale error. The bias and
other nuisance terms are fitted before. The smallest size is that of SIGMAS standard errors. It is a lower
bound: a diagnosis must also tell the effect from all others.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType

import numpy as np

from gyrodrift.diagnose.inference.parameters import unit_of
from gyrodrift.diagnose.recording.lacking import is_same_rate, lacking_values, rates_hz
from gyrodrift.diagnose.recording.recording import Recording, filled
from gyrodrift.diagnose.simulate.candidates import KINDS
from gyrodrift.diagnose.stages import DiagnosisRequest, lacking_for, recordings_of
from gyrodrift.io.progress import OnProgress, ignore_progress
from gyrodrift.values.arrays import Floats, Integers

SIGMAS = 3.0
"""Standard errors of the smallest size that shows. Chosen: noise alone rarely reaches it."""

BLOCK_S = 1.0
"""Length over which rate errors are averaged, s. Chosen: the counts of an encoder are small against a second of
motion."""

REST_DPS, LEAST_REST, LEAST_SPAN_C, LEAST_MINUTES, BOTH_WAYS, LEAST_RECORDINGS = 1.0, 0.1, 3.0, 1.0, 0.1, 3
"""A second is a rest below this rate. Advice is given below these shares of rests and of turns in the rarer direction.
It is also given below this span of the temperature, this length of all recordings and this number of them. Chosen."""

WARMUP_S = 100.0
"""Time constant of the warm-up whose smallest size is stated, s. Derived: the middle of those that a diagnosis
tries."""


@dataclass(frozen=True)
class SecondBlocks:
    """Seconds of a recording, shape (k,): mean rate of the gyro and rate of the reference, deg/s, and their terms."""

    recording: Recording

    @cached_property
    def _edges(self) -> Integers:
        step = max(1, round(BLOCK_S / self.recording.period_s))
        return np.arange(0, len(self.recording.rate_dps) - 1, step)

    def _means(self, values: Floats) -> Floats:
        sums = np.concatenate([[0.0], np.cumsum(filled(values))])[self._edges]
        means: Floats = np.diff(sums) / np.diff(self._edges)
        return means

    @cached_property
    def rate_dps(self) -> Floats:
        """Rate of the reference."""
        rate: Floats = np.diff(filled(self.recording.encoder_deg)[self._edges]) / self._seconds
        return rate

    @cached_property
    def error_dps(self) -> Floats:
        """Mean rate of the gyro minus that of the reference."""
        error: Floats = self._means(self.recording.rate_dps) - self.rate_dps
        return error

    @cached_property
    def _seconds(self) -> Floats:
        return np.diff(self._edges) * self.recording.period_s

    @property
    def angle_rad(self) -> Floats:
        """Angle in the middle of each second."""
        angle: Floats = np.deg2rad(self._means(self.recording.encoder_deg))
        return angle

    @property
    def acceleration_dps2(self) -> Floats:
        """Change of the rate within each second, per second."""
        change: Floats = np.gradient(self.rate_dps) / self._seconds
        return change

    @property
    def warm_c(self) -> Floats | None:
        """Temperature less its mean; None without a temperature."""
        if self.recording.temp_c is None:
            return None
        temp_c = self._means(self.recording.temp_c)
        warm_c: Floats = temp_c - temp_c.mean()
        return warm_c

    @property
    def settling(self) -> Floats:
        """Exponential decay since power-on."""
        t_s = self._edges[:-1] * self.recording.period_s + self.recording.powered_s
        decay: Floats = np.exp(-t_s / WARMUP_S)
        return decay


Term = Callable[[SecondBlocks], Floats | None]

TERMS: Mapping[str, tuple[Term, float]] = MappingProxyType(
    {
        "scale_factor": (lambda blocks: blocks.rate_dps, 100.0),
        "scale_asymmetry": (lambda blocks: np.abs(blocks.rate_dps), 100.0),
        "vibration_rectification": (lambda blocks: np.square(blocks.rate_dps / 100.0), 1.0),
        "latency": (lambda blocks: -blocks.acceleration_dps2, 1e3),
        "g_sensitivity": (lambda blocks: np.sin(blocks.angle_rad), 1.0),
        "warmup": (lambda blocks: blocks.settling, 1.0),
        "temp_bias": (lambda blocks: blocks.warm_c, 1.0),
        "temp_scale": (lambda blocks: None if blocks.warm_c is None else blocks.warm_c * blocks.rate_dps, 100.0),
    }
)
"""Rate error of each effect at size 1, deg/s, and the unit of the size in that of its parameter. By definition of the
parameters."""

BEFORE = {"scale_factor": (), "temp_bias": (), "warmup": (), "latency": ("scale_factor",)}
"""Effects whose terms are fitted before, beside the bias; the scale for all others."""


@dataclass(frozen=True, slots=True)
class SmallestSize:
    """Smallest size of an effect that the recordings can show."""

    effect: str
    parameter: str
    value: float
    unit: str


def smallest_sizes(recordings: Sequence[Recording]) -> tuple[SmallestSize, ...]:
    """Smallest size of each effect of TERMS that the recordings can show together."""
    every = [SecondBlocks(recording) for recording in recordings]
    sizes = []
    for name, (term, factor) in TERMS.items():
        information = sum(_information(blocks, name, term) for blocks in every)
        if information > 0.0:
            value = SIGMAS * factor / float(np.sqrt(information))
            sizes.append(SmallestSize(name, KINDS[name].parameter, value, unit_of(KINDS[name].parameter)))
    return tuple(sizes)


def _information(blocks: SecondBlocks, name: str, term: Term) -> float:
    """Inverse of the squared standard error of a size, by least squares in a recording; 0 without the term."""
    column = term(blocks)
    if column is None or len(column) < 4:
        return 0.0
    nuisances = [TERMS[nuisance][0](blocks) for nuisance in BEFORE.get(name, ("scale_factor",))]
    design = np.column_stack([np.ones(len(column)), *(values for values in nuisances if values is not None)])
    unexplained, error = (values - design @ np.linalg.lstsq(design, values)[0] for values in (column, blocks.error_dps))
    if np.square(unexplained).sum() < 1e-6 * np.square(column).sum():
        return 0.0
    variance = float(np.square(error).sum()) / max(1, len(error) - design.shape[1])
    information: float = float(np.square(unexplained).sum()) / max(variance, 1e-18)
    return information


def check_before(request: DiagnosisRequest, progress: OnProgress = ignore_progress) -> list[str]:
    """Sentences: what both sets hold and how they differ, what shows from which size, what does not, what to record.

    Raises
    ------
    DataError
        No recording can be used; the message says why.
    """
    recordings, remarks = recordings_of(request.paths, progress, request.reading)
    lines = [f"recordings: {_contents(recordings)}"]
    lacking: dict[str, str] = {}
    if request.baseline:
        of_baseline, baseline_remarks = recordings_of(request.baseline, progress, request.baseline_reading)
        remarks += [f"baseline: {remark}" for remark in baseline_remarks]
        lines += [f"baseline: {_contents(of_baseline)}", *_differences(recordings, of_baseline)]
        for name in lacking_values(recordings, of_baseline).of_one_set:
            lacking[name] = f"only one of both sets has {name}"
    shown = ", ".join(f"{size.effect} from {_short(size.value, 2)} {size.unit}" for size in smallest_sizes(recordings))
    lines.append(f"a plain regression shows: {shown or 'no effect of motion'}")
    lines += [f"does not show: {effects} ({why})" for why, effects in _hidden(recordings, lacking).items()]
    lines += [f"record instead: {advice}" for advice in advice_for(recordings)]
    return [*lines, *(f"note: {remark}" for remark in remarks)]


def _contents(recordings: Sequence[Recording]) -> str:
    """Number, length, rate, motion, temperature and columns of a set."""
    every = [SecondBlocks(recording) for recording in recordings]
    rate_dps = np.concatenate([blocks.rate_dps for blocks in every])
    minutes = sum(recording.seconds for recording in recordings) / 60.0
    temps_c = [recording.temp_c for recording in recordings if recording.temp_c is not None]
    words = [
        f"{len(recordings)} of {_short(minutes, 3)} min",
        f"{_short(rates_hz(recordings)[0], 4)} Hz",
        f"up to {_short(float(np.abs(rate_dps).max(initial=0.0)), 3)} deg/s",
        f"{100.0 * float(np.mean(np.abs(rate_dps) < REST_DPS)):.0f} % at rest",
    ]
    if temps_c:
        known_c = np.concatenate(temps_c)
        words.append(f"{np.nanmin(known_c):.1f} to {np.nanmax(known_c):.1f} °C")
    return ", ".join([*words, *(why for why, is_lacking in lacking_for(recordings).values() if is_lacking)])


def _differences(recordings: Sequence[Recording], of_baseline: Sequence[Recording]) -> list[str]:
    """Sentences on what differs between both sets beside the motion."""
    lines = [remark.replace("baseline: ", "differs: ", 1) for remark in lacking_values(recordings, of_baseline).remarks]
    if not is_same_rate(of_baseline, recordings):
        before_hz, now_hz = (_short(rate_hz, 4) for rate_hz in rates_hz(of_baseline, recordings))
        lines.append(f"differs: the baseline has {before_hz} samples a second, the recordings {now_hz}")
    return lines


def _hidden(recordings: Sequence[Recording], lacking: Mapping[str, str]) -> dict[str, str]:
    """Names of the effects that cannot show, by the reason."""
    reasons: dict[str, list[str]] = {}
    needs = lacking_for(recordings)
    for kind in KINDS.values():
        for need in kind.needs:
            why, is_lacking = needs[need]
            if is_lacking or why.removeprefix("no ") in lacking:
                reasons.setdefault(why if is_lacking else lacking[why.removeprefix("no ")], []).append(kind.name)
                break
    return {why: ", ".join(names) for why, names in reasons.items()}


def advice_for(recordings: Sequence[Recording]) -> list[str]:
    """Properties of a better set of recordings, the most important first."""
    rate_dps = np.concatenate([SecondBlocks(recording).rate_dps for recording in recordings])
    turn_deg = [float(np.abs(rate_dps[rate_dps * way > REST_DPS]).sum()) for way in (1.0, -1.0)]
    moving_dps = np.abs(rate_dps[np.abs(rate_dps) > REST_DPS])
    spans_c = [float(np.nanmax(r.temp_c) - np.nanmin(r.temp_c)) for r in recordings if r.temp_c is not None]
    advice = {
        "a minute or more in all": sum(recording.seconds for recording in recordings) < 60.0 * LEAST_MINUTES,
        "turns: without motion only bias, noise, clock and link show": not len(moving_dps),
        "turns in both directions": bool(len(moving_dps)) and min(turn_deg) < BOTH_WAYS * sum(turn_deg),
        "several speeds": len(moving_dps) > 1
        and float(np.quantile(moving_dps, 0.9) / np.quantile(moving_dps, 0.1)) < 2,
        "rests of some seconds between the turns": float(np.mean(np.abs(rate_dps) < REST_DPS)) < LEAST_REST,
        f"a change of temperature of {LEAST_SPAN_C:g} °C": bool(spans_c) and max(spans_c) < LEAST_SPAN_C,
        f"{LEAST_RECORDINGS} recordings or more, so that each checks the others": len(recordings) < LEAST_RECORDINGS,
    }
    return [words for words, is_needed in advice.items() if is_needed]


def _short(value: float, digits: int) -> str:
    return f"{float(f'{value:.{digits}g}'):g}"
