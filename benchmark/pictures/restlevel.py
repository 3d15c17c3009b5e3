"""The picture of restlevel in the docs: its hypotheses in a minute and a half that begins in motion.

Drawn by `python -m benchmark pictures.restlevel --out docs/restlevel.png`; matplotlib comes with the workstation
extra.
"""

import argparse
from pathlib import Path

import matplotlib as mpl
import numpy as np

from gyrodrift.filters.restlevel.model import RestlevelParams, RestlevelState
from gyrodrift.filters.restlevel.step import coefficients, step

mpl.use("Agg")
from matplotlib import pyplot as plt
from matplotlib.axes import Axes

RATE_HZ = 100.0
BIAS_DPS = 0.7
NOISE_DPS = 0.05
MOTION = ((20.0, 12), (0.0, 4), (-35.0, 9), (6.0, 8), (0.0, 5), (25.0, 12), (-6.0, 9), (0.0, 4), (-20.0, 14), (0.0, 8))
"""Rates in deg/s and for how many seconds; half a second from one to the next."""

SEED = 4
EVERY = 25
"""Samples to a point of the picture."""

GRAY, BLUE, RED = "0.6", "tab:blue", "tab:red"


def motion() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times in s, measured rates in deg/s, true yaw in deg, shape (n,)."""
    ends_s = np.cumsum([seconds for _, seconds in MOTION])
    knots_s = np.column_stack([np.r_[0.0, ends_s[:-1] + 0.5], ends_s]).ravel()
    t_s = np.arange(round(ends_s[-1] * RATE_HZ)) / RATE_HZ
    true_dps = np.interp(t_s, knots_s, np.repeat([rate_dps for rate_dps, _ in MOTION], 2))
    rate_dps = true_dps + BIAS_DPS + np.random.default_rng(SEED).normal(0.0, NOISE_DPS, len(t_s))
    return t_s, rate_dps, integral_deg(true_dps)


def integral_deg(rate_dps: np.ndarray) -> np.ndarray:
    """Angle of a rate by the trapezoidal rule, deg, shape (n,)."""
    return np.cumsum(0.5 * (rate_dps + np.r_[rate_dps[0], rate_dps[:-1]])) / RATE_HZ


def draw(path: Path) -> None:
    """Write the picture."""
    t_s, rate_dps, true_deg = motion()
    c, s = coefficients(RestlevelParams()), RestlevelState()
    hypotheses: list[tuple[float, float, float]] = []
    rows = []
    for each_s, each_dps in zip(t_s.tolist(), rate_dps.tolist(), strict=True):
        step(c, s, each_s, each_dps)
        rows.append((s.yaw_deg, s.yaw_sigma_deg, s.bias_dps, s.rest_probability))
        if s.samples % EVERY == 0:
            hypotheses += [(each_s, h.bias_dps, h.weight) for h in s.hypotheses if h.weight > 0.0]
    columns = (t_s, rate_dps, true_deg, integral_deg(rate_dps))
    t_s, rate_dps, true_deg, plain_deg = (column[::EVERY] for column in columns)
    yaw_deg, sigma_deg, bias_dps, resting = np.array(rows[::EVERY]).T
    mpl.rcParams.update({"font.size": 9.0})
    figure, (rates, biases, errors) = plt.subplots(3, 1, figsize=(8.0, 6.6), sharex=True, layout="constrained")
    _rates(rates, t_s, rate_dps, resting)
    _biases(biases, t_s, bias_dps, hypotheses)
    _errors(errors, t_s, plain_deg - true_deg, yaw_deg - true_deg, sigma_deg)
    figure.savefig(path, dpi=110)
    plt.close(figure)


def _rates(axes: Axes, t_s: np.ndarray, rate_dps: np.ndarray, resting: np.ndarray) -> None:
    axes.plot(t_s, rate_dps, color=GRAY, linewidth=0.6)
    axes.fill_between(t_s, -40.0, 40.0, where=(resting > 0.5).tolist(), color=BLUE, alpha=0.15, linewidth=0.0)
    axes.set(ylabel="measured rate, deg/s", ylim=(-40.0, 40.0), title="shaded: probably at rest")


def _biases(axes: Axes, t_s: np.ndarray, bias_dps: np.ndarray, hypotheses: list[tuple[float, float, float]]) -> None:
    at_s, each_dps, weights = np.array(hypotheses).T
    axes.axhline(BIAS_DPS, color="black", linewidth=0.8, linestyle=":")
    axes.scatter(at_s, each_dps, s=30.0 * weights + 0.5, color=GRAY, linewidths=0.0)
    axes.plot(t_s, bias_dps, color=BLUE, linewidth=1.2)
    axes.set(ylabel="bias, deg/s", title="gray: every hypothesis, as large as it is probable; dotted: the truth")
    axes.set_yscale("symlog", linthresh=1.0)
    axes.set_yticks([-1.0, 0.0, 1.0, 10.0], ["−1", "0", "1", "10"])


def _errors(axes: Axes, t_s: np.ndarray, plain_deg: np.ndarray, error_deg: np.ndarray, sigma_deg: np.ndarray) -> None:
    axes.plot(t_s, plain_deg, color=RED, linewidth=1.0, label="plain integration")
    axes.plot(t_s, error_deg, color=BLUE, linewidth=1.2, label="restlevel")
    axes.fill_between(t_s, -2.0 * sigma_deg, 2.0 * sigma_deg, color=BLUE, alpha=0.15, linewidth=0.0, label="± 2 sigma")
    axes.set(xlabel="time, s", ylabel="yaw error, deg", ylim=(-25.0, 65.0), xlim=(0.0, t_s[-1]))
    axes.legend(loc="upper left")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, required=True, metavar="FILE.png")
    draw(parser.parse_args().out)
