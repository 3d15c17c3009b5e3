"""Equations 1 to 8 of HDR as they are printed, over whole lists, and six worked cases of 3,000 samples."""

from collections.abc import Callable, Mapping
from math import sin
from random import Random

from gyrodrift.filters.hdr import HdrParams

COLUMNS = ("lpf_dps", "i_dps", "omega_dps", "omega_d_dps", "yaw_deg")
SAMPLES = 3000

Stream = list[tuple[float, float]]
"""t_s and rate_dps of each sample."""


def as_printed(p: HdrParams, stream: Stream) -> list[tuple[float, ...]]:
    """COLUMNS of each sample. It shares nothing with the filter but the equations."""
    sign = [0.0] * len(stream)
    rows: list[tuple[float, ...]] = []
    run_length = 0
    for i, (t_s, raw) in enumerate(stream):
        if i == 0:
            lpf = omega = omega_d = raw
            integrator = yaw = 0.0
        else:
            dt_s = t_s - stream[i - 1][0]
            previous = rows[-1][2]
            run_length = run_length + 1 if i >= 2 and sign[i - 1] == sign[i - 2] else 1
            switch = 1.0 if abs(previous) < p.theta_w_dps else 0.0
            attenuation = (1.0 + p.c1) / (1.0 + p.c1 * float(run_length) ** p.c2)
            integrator = rows[-1][1] - sign[i - 1] * switch * attenuation * p.i_c_dps
            lpf = (raw * dt_s + p.tau_s * rows[-1][0]) / (dt_s + p.tau_s)
            omega = lpf + integrator
            omega_d = omega + p.tau_s / dt_s * (omega - previous)
            yaw = rows[-1][4] + omega_d * dt_s
        sign[i] = (omega > 0.0) - (omega < 0.0)
        rows.append((lpf, integrator, omega, omega_d, yaw))
    return rows


def _stream(step_s: Callable[[Random], float], rate_dps: Callable[[Random, int], float]) -> Stream:
    """From 12.5 s on; numbers as a device would print them."""
    random, t_s, out = Random(1), 12.5, []
    for i in range(SAMPLES):
        out.append((round(t_s, 6), round(rate_dps(random, i), 6)))
        t_s += step_s(random)
    return out


def _even(_: Random) -> float:
    return 0.01


def _with_gaps(random: Random) -> float:
    return 0.01 if random.random() < 0.98 else random.uniform(0.02, 1.5)


def _varying(random: Random) -> float:
    return random.uniform(0.002, 0.03)


def _resting(random: Random, _: int) -> float:
    return 0.12 + random.gauss(0.0, 0.15)


def _turning(random: Random, i: int) -> float:
    return _resting(random, i) + (60.0 * sin(i / 80.0) if 500 <= i < 1700 else 0.0)


def _with_zeros(random: Random, i: int) -> float:
    return 0.0 if i < 5 or i % 5 else random.choice([-0.2, 0.0, 0.2])


PUBLISHED = HdrParams(i_c_dps=0.0006, tau_s=0.9447, theta_w_dps=0.5608, c1=0.7839, c2=1.2161)

CASES: Mapping[str, tuple[HdrParams, Stream]] = {
    "gaps": (PUBLISHED, _stream(_with_gaps, _resting)),
    "other_parameters": (HdrParams(0.003, 0.05, 1.2, 1.7, 0.4), _stream(_even, _resting)),
    "steady": (PUBLISHED, _stream(_even, _resting)),
    "turns": (PUBLISHED, _stream(_even, _turning)),
    "variable_dt": (PUBLISHED, _stream(_varying, _resting)),
    "zeros": (PUBLISHED, _stream(_even, _with_zeros)),
}
