"""A session as a picture: rate, yaw, time and noise; matplotlib comes with the workstation extra."""

from typing import BinaryIO, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

from gyrodrift.arrays import Floats
from gyrodrift.describe.allan import FLICKER_FLOOR, allan_errors
from gyrodrift.describe.describe import GAP_PERIODS
from gyrodrift.describe.host import host_delays_s
from gyrodrift.describe.values import RestSource, SessionDescription
from gyrodrift.session.session import Session

POINTS = 2000
"""A line has no more points than this: each part of it is drawn as its mean within its range, so that spikes stay."""

SHADES = 300
"""So many gaps and stretches are drawn, the longest ones."""

MARK = 0.96
"""Gaps are marked from this height of the axes up: in time most of them are too short to be seen."""

MEASURED, REFERENCE, REST, GAP, QUIET = "tab:blue", "tab:orange", "tab:green", "tab:red", "0.55"
UNDATED = {"png": {"Software": None}, "svg": {"Date": None}, "pdf": {"CreationDate": None}}
"""The same session gives the same picture."""


def draw(session: Session, description: SessionDescription, file: BinaryIO, ending: str) -> None:
    """Write a picture of four panels to a file, as png, svg or pdf."""
    figure = Figure(figsize=(13.0, 8.0), layout="constrained")
    grid = figure.add_gridspec(4, 2)
    rate = "" if description.rate_hz is None else f", {description.rate_hz:.6g} Hz"
    figure.suptitle(f"{session.name}: {description.samples} samples, {description.duration_s:.6g} s{rate}", fontsize=12)
    t_s = _seconds(session)
    _draw_rate(_styled(figure.add_subplot(grid[:2, 0])), t_s, session, description)
    _draw_yaw(_styled(figure.add_subplot(grid[:2, 1])), t_s, session)
    if session.t_host_s is None:
        _draw_steps(_styled(figure.add_subplot(grid[2:, 0])), t_s)
    else:
        _draw_steps(_styled(figure.add_subplot(grid[2, 0])), t_s)
        _draw_delays(_styled(figure.add_subplot(grid[3, 0])), t_s, session, description)
    _draw_noise(_styled(figure.add_subplot(grid[2:, 1])), description)
    figure.savefig(file, format=ending, dpi=110, metadata=UNDATED[ending])


def _styled(axes: Axes) -> Axes:
    axes.grid(alpha=0.3)
    axes.tick_params(labelsize=8)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    return axes


def _name(axes: Axes, title: str, x: str, y: str) -> None:
    axes.set_title(title, fontsize=10, loc="left")
    axes.set_xlabel(x, fontsize=9)
    axes.set_ylabel(y, fontsize=9)


def _legend(axes: Axes, *more: Axes) -> None:
    handles = [handle for one in (axes, *more) for handle in one.get_legend_handles_labels()[0]]
    axes.legend(handles=handles, fontsize=8, loc="best", framealpha=0.9)


def _seconds(session: Session) -> Floats:
    """Device time after the first sample, s."""
    finite = session.t_device_s[np.isfinite(session.t_device_s)]
    return session.t_device_s - (finite[0] if len(finite) else 0.0)


class Thinned(NamedTuple):
    """A line in parts, every array of the shape (m,): where each begins, its range and its mean."""

    x: Floats
    low: Floats
    mean: Floats
    high: Floats


def thinned(x: Floats, y: Floats) -> Thinned:
    """The line in at most `POINTS` parts of equally many samples; what is no number is passed over."""
    starts = np.arange(0, len(y), max(1, -(-len(y) // POINTS)))
    y = np.where(np.isfinite(y), y, np.nan)
    if len(starts) == len(y):
        return Thinned(x, y, y, y)
    counts = np.add.reduceat(np.isfinite(y), starts, dtype=np.float64)
    sums = np.add.reduceat(np.nan_to_num(y), starts)
    means = np.where(counts > 0.0, sums / np.maximum(counts, 1.0), np.nan)
    return Thinned(x[starts], np.fmin.reduceat(y, starts), means, np.fmax.reduceat(y, starts))


def _plot(axes: Axes, x: Floats, y: Floats, colour: str, label: str = "") -> None:
    parts = thinned(x, y)
    if len(parts.x) < len(x):
        axes.fill_between(parts.x, parts.low, parts.high, color=colour, alpha=0.35, linewidth=0.6)
    marker = "." if len(x) < 2 else ""  # a line through one point is invisible
    axes.plot(parts.x, parts.mean, color=colour, linewidth=1.0, marker=marker, label=label)


def _draw_rate(axes: Axes, t_s: Floats, session: Session, description: SessionDescription) -> None:
    _plot(axes, t_s, session.rate_dps, MEASURED, "measured rate")
    by = "still, by the encoder" if description.still_by is RestSource.ENCODER else "steady (a guess)"
    longest = sorted(description.stretches, key=lambda one: one.start_s - one.end_s)[:SHADES]
    for number, one in enumerate(longest):
        label = f"_{by}" if number else by
        axes.axvspan(one.start_s, one.end_s, color=REST, alpha=0.18, linewidth=0, label=label)
    starts_s, ends_s = _gaps(t_s, description)
    for number, (start_s, end_s) in enumerate(zip(starts_s, ends_s, strict=True)):
        label = "_gap" if number else "gap"
        axes.axvspan(start_s, end_s, color=GAP, alpha=0.2, linewidth=0)
        axes.axvspan(start_s, end_s, MARK, color=GAP, linewidth=0.8, label=label)
    _name(axes, "Rate", "device time, s", "deg/s")
    _legend(axes)


def _gaps(t_s: Floats, description: SessionDescription) -> tuple[list[float], list[float]]:
    """Where the longest gaps begin and end, s."""
    if description.rate_hz is None:
        return [], []
    steps_s = np.diff(t_s)
    before = np.flatnonzero(steps_s > GAP_PERIODS / description.rate_hz)
    before = before[np.argsort(-steps_s[before])[:SHADES]]
    return t_s[before].tolist(), t_s[before + 1].tolist()


def _draw_yaw(axes: Axes, t_s: Floats, session: Session) -> None:
    steps_s = np.diff(t_s, prepend=t_s[0])
    turns_deg = np.where((steps_s > 0.0) & np.isfinite(session.rate_dps), session.rate_dps * steps_s, 0.0)
    _plot(axes, t_s, np.cumsum(turns_deg), MEASURED, "integrated rate, no correction")
    if session.encoder_deg is not None:
        known = np.flatnonzero(np.isfinite(session.encoder_deg))
        zero_deg = session.encoder_deg[known[0]] if len(known) else 0.0
        _plot(axes, t_s, session.encoder_deg - zero_deg, REFERENCE, "encoder")
        _name(axes, "Yaw from the start", "device time, s", "deg")
        _legend(axes)
    elif session.temp_c is not None:
        right = axes.twinx()
        _plot(right, t_s, session.temp_c, GAP, "temperature (right)")
        right.set_ylabel("°C", fontsize=9)
        right.tick_params(labelsize=8)
        right.spines["top"].set_visible(False)
        _name(axes, "Yaw from the start, and temperature", "device time, s", "deg")
        _legend(axes, right)
    else:
        _name(axes, "Yaw from the start", "device time, s", "deg")
        _legend(axes)


def _draw_steps(axes: Axes, t_s: Floats) -> None:
    steps_ms = np.round(1e3 * np.diff(t_s), 6)  # finer is what is left of rounding
    _plot(axes, t_s[1:], steps_ms, MEASURED)
    _name(axes, "Step of device time", "device time, s", "ms")


def _draw_delays(axes: Axes, t_s: Floats, session: Session, description: SessionDescription) -> None:
    """How much later than the soonest possible each sample arrived."""
    delays_s = host_delays_s(session, None if description.rate_hz is None else 1.0 / description.rate_hz)
    if delays_s is not None:
        _plot(axes, t_s, 1e3 * delays_s, QUIET)
    host, drift = description.host, ""
    if host is not None and host.drift_ppm is not None and host.drift_sd_ppm is not None:
        drift = f"; the clocks drift {host.drift_ppm:.1f} ± {host.drift_sd_ppm:.1f} ppm"
    _name(axes, f"Arrival after the soonest possible{drift}", "device time, s", "ms")


def _draw_noise(axes: Axes, description: SessionDescription) -> None:
    allan = description.allan
    if allan is None:
        axes.text(0.5, 0.5, "no stretch of 30 s without motion", ha="center", va="center", transform=axes.transAxes)
        axes.set_axis_off()
        return
    taus_s, deviations_dps = allan.taus_s, allan.deviations_dps
    errors = allan_errors(taus_s, allan.stretch.end_s - allan.stretch.start_s)
    band = (deviations_dps * (1.0 - errors), deviations_dps * (1.0 + errors))
    axes.fill_between(taus_s, *band, color=MEASURED, alpha=0.2, linewidth=0)
    axes.plot(taus_s, deviations_dps, ".-", color=MEASURED, label="Allan deviation, and its standard error")
    if deviations_dps.any():
        axes.set(xscale="log", yscale="log")
        _label_plainly(axes.xaxis, taus_s)
        _label_plainly(axes.yaxis, deviations_dps)
    walk, floor_dps = allan.angle_random_walk_deg_rts, allan.bias_instability_dps
    if walk is not None:
        label = f"angle random walk {walk:.3g} deg/√s"
        axes.plot(taus_s, walk / np.sqrt(taus_s), "--", color=REFERENCE, linewidth=1.2, label=label)
    if floor_dps is not None:
        label = f"bias instability {floor_dps:.3g} deg/s"
        axes.axhline(FLICKER_FLOOR * floor_dps, color=REST, linestyle=":", linewidth=1.4, label=label)
    span = f"{allan.stretch.start_s:.0f} – {allan.stretch.end_s:.0f} s"
    _name(axes, f"Noise over the longest still stretch, {span}", "averaging time, s", "deg/s")
    _legend(axes)


def _label_plainly(axis: Axis, values: Floats) -> None:
    """Decades as 0.01 and 10, and what is between them where there is less than one."""
    axis.set_major_formatter(StrMethodFormatter("{x:g}"))
    is_wide = values.max() > 10.0 * values.min()
    axis.set_minor_locator(LogLocator(subs=(2.0, 5.0)))
    axis.set_minor_formatter(NullFormatter() if is_wide else StrMethodFormatter("{x:g}"))
