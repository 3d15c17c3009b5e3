"""Sessions of a case as files of comma-separated values with all digits."""

from collections.abc import Callable
from dataclasses import replace
from enum import IntEnum
from pathlib import Path

import numpy as np

from simulators.flaws import Floats, Rng, Signals, coarse_encoder
from simulators.sessions import SESSIONS, columns_of
from simulators.unseen.benches import BENCHES
from simulators.unseen.cases import CASES, REAL, UnseenCase
from simulators.unseen.flaws import rounded
from simulators.unseen.motions import commanded_dps

SEED = 73091
"""Seed of all cases; a seed of the evaluation does not change them."""


class Stream(IntEnum):
    """Uses of random numbers; each has a generator of its own."""

    MOTION = 0
    BENCH = 1
    DEVICE = 2
    ARRIVALS = 3
    TEMPERATURE = 4
    NOISE = 5
    FLAW = 6


def simulated(number: int, side: str, index: int) -> Signals:
    """Session `index` from 0 of a side of a case, whose numbers begin with 1."""
    case = CASES[number - 1]
    rngs = {use: np.random.default_rng([SEED, number, int(side == REAL), index, use]) for use in Stream}
    seconds = rngs[Stream.MOTION].uniform(*case.seconds)
    return _read(case, side, _moved(case, side, seconds, rngs.__getitem__), rngs.__getitem__)


def _moved(case: UnseenCase, side: str, seconds: float, rng: Callable[[Stream], Rng]) -> Signals:
    """A session of a perfect gyro."""
    bench = BENCHES[case.bench]
    motion = (seconds, case.styles, case.amplitude_dps, case.most_hz, bench.most_dps2)
    rate_dps, angle_deg = bench.simulate(commanded_dps(rng(Stream.MOTION), *motion), case.rate_hz, rng(Stream.BENCH))
    t_s = np.arange(len(rate_dps)) / case.rate_hz
    boot_s = rng(Stream.DEVICE).uniform(2.0, 5.0) if case.is_powered_on and side == REAL else 0.0
    arrival_s = _arrivals_s(t_s, side, rng(Stream.ARRIVALS)) if side in case.arrivals else None
    temp_c = _temperatures_c(t_s, rng(Stream.TEMPERATURE)) if side in case.temperatures else None
    return Signals(t_s, t_s + boot_s, arrival_s, rate_dps, rate_dps, angle_deg, temp_c)


def _arrivals_s(t_s: Floats, side: str, rng: Rng) -> Floats:
    """Arrivals some 1.4 ms after the samples; the clock of a real host began long before."""
    began_s = rng.uniform(5, 900) * (side == REAL)
    arrivals: Floats = np.maximum.accumulate(began_s + t_s + 0.0012 + rng.exponential(0.0002, len(t_s)))
    return arrivals


def _temperatures_c(t_s: Floats, rng: Rng) -> Floats:
    """The air's temperature goes 12 to 20 °C up or down and back, about once; the die follows within 5 s."""
    die_c, swing_c = rng.uniform(20, 30), rng.uniform(12, 20) * rng.choice([-1, 1])
    air_c: Floats = die_c + swing_c / 2 * (1 - np.cos(2 * np.pi * rng.uniform(0.7, 1.2) * t_s / t_s[-1]))
    followed, share = np.empty_like(air_c), 1 - np.exp(-(t_s[1] - t_s[0]) / 5.0)
    for index, value_c in enumerate(air_c.tolist()):
        die_c += share * (value_c - die_c)
        followed[index] = die_c
    return followed


def _read(case: UnseenCase, side: str, signals: Signals, rng: Callable[[Stream], Rng]) -> Signals:
    """Signals with the flaw of the real side between them and their words, noise and bias, as they are logged."""
    is_real = side == REAL
    if is_real and case.dynamics is not None:
        signals = case.dynamics(signals, rng(Stream.FLAW))
    bias_dps = case.bias_dps * (1.0 + 0.15 * rng(Stream.DEVICE).standard_normal()) if is_real else 0.0
    sigma_dps = (case.real_noise if is_real else case.sim_noise) * np.sqrt(case.rate_hz / 2.0)
    noise_dps = sigma_dps * rng(Stream.NOISE).standard_normal(len(signals.t_s))
    signals = replace(signals, rate_dps=signals.rate_dps + bias_dps + noise_dps)
    if is_real and case.readout is not None:
        signals = case.readout(signals, rng(Stream.FLAW))
    if is_real and signals.temp_c is not None:
        error_c = 0.02 * rng(Stream.TEMPERATURE).standard_normal(len(signals.t_s))
        signals = replace(signals, temp_c=signals.temp_c + error_c)
    return _in_words(case, signals, rng, is_real=is_real)


def _in_words(case: UnseenCase, signals: Signals, rng: Callable[[Stream], Rng], *, is_real: bool) -> Signals:
    """Rates in words of 16 bits and angles in counts, where the case has them."""
    if is_real and case.range_dps:
        signals = rounded(case.range_dps / 32768)(signals, rng(Stream.FLAW))
    counts = case.counts if is_real else case.sim_counts
    return coarse_encoder(counts)(signals, rng(Stream.FLAW)) if counts else signals


def write_set(folder: Path, number: int, side: str) -> None:
    """The sessions of a side of a case."""
    folder.mkdir(parents=True)
    for index in range(SESSIONS):
        columns = columns_of(simulated(number, side, index))
        rows = zip(*(column.tolist() for column in columns.values()), strict=True)
        lines = [",".join(columns), *(",".join(map(repr, row)) for row in rows)]
        (folder / f"{index + 1}.csv").write_text("\n".join(lines) + "\n")
