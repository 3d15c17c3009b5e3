"""The description of a session as text: groups of lines, with a ! before values that deserve a second look.

Values that no sensor can measure are reported, and left out because charts would show nothing else.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from gyrodrift.facts.allan import Allan
from gyrodrift.facts.gravity import SessionAxes
from gyrodrift.facts.host import HostClock
from gyrodrift.facts.rests import RestSource, Stretch
from gyrodrift.facts.session_facts import SessionFacts
from gyrodrift.session.aids import RowAids
from gyrodrift.session.checks.finding import SessionFinding
from gyrodrift.session.mcap.raw import RawSize
from gyrodrift.session.session import Session
from gyrodrift.values.aid import Aid
from gyrodrift.values.arrays import Floats
from gyrodrift.values.noise import FLICKER_FLOOR, FLICKER_WORDS, hourly_rate_text, random_walk_text

MOST_DPS = 100_000.0
"""The fastest gyro on sale, the ADXRS649, measures up to 20,000 deg/s, extended 50,000 (its data sheet, rev. B)."""

LEAST_C, MOST_C = -273.15, 1000.0
"""Absolute zero, and far above what silicon survives (175 °C)."""

MOST_DEG = 1e9
"""Angle of an encoder: 2.8 million turns, two months at 33 turns a minute."""

MOST_S = 1e11
"""A time, also one since 1970: 3000 years."""

STRETCHES_SHOWN = 6
TEXT_SHOWN = 90

JITTER_ODD = 0.1
"""Scatter of the time steps, in periods, that deserves a second look."""

DRIFT_ODD_PPM = 1000.0
"""Yaw is wrong by the same share as the clock: 0.1 %."""

DRIFT_ROUGH_PPM = 5.0
DRIFT_UNCERTAIN_PPM = 100.0
"""A standard error above this means that no line relates the clocks: one of them stepped."""

DELAY_ODD_S = 0.1
NOISY_DPS = 2.0
"""No gyro at rest scatters by this much: the encoder was off, or the table shook."""

AID_UNITS = {"standing": "", "heading": "deg", "turn_rate": "deg/s", "wheels": "difference", "speed": "m/s"}
"""Units of second sources by kind."""

REST_HEADINGS = {
    RestSource.ENCODER: "at rest, by the encoder",
    RestSource.RATE: "steady rate: probably at rest, but a constant spin looks the same",
}


@dataclass(frozen=True, slots=True)
class Impossible:
    """Values of a column that no sensor can measure: how many, and the possible range."""

    column: str
    count: int
    possible: str

    def __str__(self) -> str:
        return f"{self.count} values outside of {self.possible}, which no sensor can measure"


def impossible_values(session: Session) -> list[Impossible]:
    """Impossible values by column; only columns that have any."""
    return [
        Impossible(name, int(np.count_nonzero(is_wrong)), possible)
        for name, _, is_wrong, possible in _columns(session)
        if is_wrong.any()
    ]


def possible_part(session: Session) -> Session:
    """The session with NaN for impossible values."""
    changed = {
        name: np.where(is_wrong, np.nan, values) for name, values, is_wrong, _ in _columns(session) if is_wrong.any()
    }
    return replace(session, **changed) if changed else session  # type: ignore[arg-type]  # all of them are columns


def _columns(session: Session) -> Iterator[tuple[str, Floats, np.ndarray, str]]:
    """Name, values, mask of the impossible ones, and the possible range in words."""
    yield "rate_dps", session.rate_dps, _is_beyond(session.rate_dps, -MOST_DPS, MOST_DPS), f"±{MOST_DPS:,.0f} deg/s"
    for name in ("t_device_s", "t_host_s"):
        times_s = getattr(session, name)
        if times_s is not None:
            yield name, times_s, _is_beyond(times_s, -MOST_S, MOST_S), f"±{MOST_S:.0e} s"
    if session.temp_c is not None:
        yield "temp_c", session.temp_c, _is_beyond(session.temp_c, LEAST_C, MOST_C), f"{LEAST_C} to {MOST_C:.0f} °C"
    if session.encoder_deg is not None:
        is_wrong = _is_beyond(session.encoder_deg, -MOST_DEG, MOST_DEG)
        yield "encoder_deg", session.encoder_deg, is_wrong, f"±{MOST_DEG:.0e} deg"


def _is_beyond(values: Floats, least: float, most: float) -> np.ndarray:
    """NaN is a missing value and is not beyond."""
    with np.errstate(invalid="ignore"):
        is_beyond: np.ndarray = (values < least) | (values > most)
    return is_beyond


class TableLine(NamedTuple):
    """A line of the table; odd values get a mark."""

    name: str
    value: str
    is_odd: bool = False


class Group(NamedTuple):
    """Lines under a heading."""

    heading: str
    lines: list[TableLine]


def lines_of(groups: Sequence[Group]) -> Iterator[str]:
    """Lines of the whole text."""
    width = max(len(line.name) for group in groups for line in group.lines)
    for heading, lines in groups:
        yield from ("", heading)
        for name, value, is_odd in lines:
            yield f"{'!' if is_odd else ' '} {name:{width}}  {value}"


def groups_of(
    session: Session,
    facts: SessionFacts,
    raw: RawSize | None = None,
    findings: Sequence[SessionFinding] = (),
) -> list[Group]:
    """Everything that `info` says about a session, the metadata of its file last.

    `facts` are those of its possible part, `raw` is the size of the recorded link bytes, and `findings` come from the
    checks of the session.
    """
    checked = [TableLine(finding.id, str(finding), is_odd=True) for finding in findings]
    checks = [Group("checks", checked)] if checked else []
    wrong = [TableLine(impossible.column, str(impossible), is_odd=True) for impossible in impossible_values(session)]
    impossible_group = [Group("impossible values, left out below", wrong)] if wrong else []
    groups = [*_groups(facts), Group("bytes of the link", [_raw(raw)]), *_metadata(session)]
    return [*checks, *impossible_group, *groups]


def _raw(raw: RawSize | None) -> TableLine:
    if raw is None:
        return TableLine("raw", "none recorded; record --raw keeps them")
    return TableLine("raw", f"{raw.reads} reads, {raw.total_bytes / 1000.0:.4g} kB; replay --raw plays them again")


def _groups(facts: SessionFacts) -> Iterator[Group]:
    yield Group("samples", list(_samples(facts)))
    yield Group("host clock", list(_host(facts.host)))
    yield Group("values", [*_values(facts), *_axes(facts.axes), *_device_yaw(facts.session)])
    if facts.session.aids:
        yield Group("second sources", list(_second_sources(facts.session.aids)))
    yield Group(REST_HEADINGS[facts.still_by], list(_stretches(facts)))
    yield Group("noise", list(_noise(facts.allan)))


def _samples(facts: SessionFacts) -> Iterator[TableLine]:
    yield TableLine("samples", str(facts.samples))
    yield TableLine("duration", f"{facts.duration_s:.6g} s")
    if facts.rate_hz is None or facts.jitter_s is None:
        yield TableLine("rate", "unknown: device time never goes forward", is_odd=True)
    else:
        yield TableLine("rate", f"{facts.rate_hz:.6g} Hz")
        is_odd = facts.jitter_s * facts.rate_hz > JITTER_ODD
        yield TableLine("jitter", f"{_milliseconds(facts.jitter_s)}, scatter of the time steps", is_odd)
    gaps = facts.gaps
    missing = f": {gaps.missing} samples missing" if gaps.count or gaps.missing else ""
    longest = f", the longest gap {gaps.longest_s:.3g} s" if gaps.count else ""
    yield TableLine("gaps", f"{gaps.count or 'none'}{missing}{longest}", bool(missing))
    if facts.steps_not_forward:
        words = f"{facts.steps_not_forward} steps do not go forward; the filter skips these samples"
        yield TableLine("time", words, is_odd=True)
    if facts.rates_not_finite:
        words = f"{facts.rates_not_finite} are not finite; the filter skips these samples"
        yield TableLine("rates", words, is_odd=True)


def _milliseconds(seconds: float) -> str:
    return f"{round(1e3 * seconds, 6):.3g} ms"


def _host(host: HostClock | None) -> Iterator[TableLine]:
    if host is None:
        yield TableLine("arrival", "not recorded")
        return
    if host.drift_ppm is None or host.drift_sd_ppm is None:
        yield TableLine("drift", "unknown: the session is too short")
    else:
        is_odd = abs(host.drift_ppm) > DRIFT_ODD_PPM or host.drift_sd_ppm > DRIFT_UNCERTAIN_PPM
        digits = 0 if host.drift_sd_ppm > DRIFT_ROUGH_PPM else 2
        drift = f"{host.drift_ppm:z.{digits}f} ± {host.drift_sd_ppm:.{digits}f}"
        uneven = "; too uneven for a drift: one of the clocks may have been set"
        uneven *= host.drift_sd_ppm > DRIFT_UNCERTAIN_PPM
        yield TableLine("drift", f"{drift} ppm, clock of the device against the host's{uneven}", is_odd)
    late = f"95 % of the samples arrive within {_milliseconds(host.delay_p95_s)} of the earliest"
    yield TableLine("delay", late, host.delay_p95_s > DELAY_ODD_S)


def _values(facts: SessionFacts) -> Iterator[TableLine]:
    if facts.rate is None:
        yield TableLine("rate", "no finite value", is_odd=True)
    else:
        low, high, mean = facts.rate.min_dps, facts.rate.max_dps, facts.rate.mean_dps
        stuck = ": never changes" if low == high and facts.samples > 1 else ""
        yield TableLine("rate", f"{low:.6g} … {high:.6g} deg/s, mean {mean:.4g} deg/s{stuck}", bool(stuck))
    encoder, temperature = facts.encoder, facts.temperature
    if encoder is None:
        yield TableLine("encoder", "none")
    elif encoder.smallest_step_deg is None:
        yield TableLine("encoder", f"{encoder.min_deg:.6g} deg, never moves")
    else:
        step = f"smallest step {encoder.smallest_step_deg:.4g} deg"
        yield TableLine("encoder", f"{encoder.min_deg:.6g} … {encoder.max_deg:.6g} deg, {step}")
    if temperature is None:
        yield TableLine("temperature", "none")
    else:
        ends = f"{temperature.first_c:.2f} → {temperature.last_c:.2f} °C from start to end"
        yield TableLine("temperature", f"{temperature.min_c:.2f} … {temperature.max_c:.2f} °C, {ends}")


def _axes(axes: SessionAxes | None) -> Iterator[TableLine]:
    """Lines about three axes; none for a device with one."""
    if axes is None:
        return
    yield TableLine("axes", f"three axes, {'accelerometer' if axes.accel_norm_mps2 else 'no accelerometer'}")
    spans = ", ".join(f"{name} {low:.6g} … {high:.6g}" for name, (low, high) in axes.rates_dps.items())
    yield TableLine("rates", f"{spans} deg/s")
    if axes.accel_norm_mps2:
        without = f"; {axes.without_accel} samples without" if axes.without_accel else ""
        yield TableLine("acceleration", f"median length {axes.accel_norm_mps2:.4g} m/s²{without}", bool(without))


def _device_yaw(session: Session) -> Iterator[TableLine]:
    """A line about the yaw of the filter in the device; none for a device without one."""
    if session.device_yaw_deg is None:
        return
    known_deg = session.device_yaw_deg[np.isfinite(session.device_yaw_deg)]
    name = session.metadata.get("device", {}).get("device_filter", "")
    words = f"{known_deg.min():.6g} … {known_deg.max():.6g} deg, the device's own yaw{f' by {name}' if name else ''}"
    without = len(session.device_yaw_deg) - len(known_deg)
    yield TableLine("device yaw", words + (f"; {without} samples without" if without else ""))


def _second_sources(aids: RowAids) -> Iterator[TableLine]:
    """A line for each second source."""
    by_name: dict[str, list[Aid]] = {}
    for _, aid in aids:
        by_name.setdefault(aid.name, []).append(aid)
    for name, of_source in by_name.items():
        values, unit = [aid.value for aid in of_source], AID_UNITS[of_source[0].kind]
        span = f"{min(values):.5g} … {max(values):.5g}{f' {unit}' if unit else ''}"
        times = f"{len(of_source)} time{'s' * (len(of_source) > 1)}"
        yield TableLine(_printable(name), f"{of_source[0].kind.replace('_', ' ')}, {times}, {span}")


def _stretches(facts: SessionFacts) -> Iterator[TableLine]:
    """A line for all rests, then the longest in order of time."""
    rests = facts.stretches
    if not rests:
        yield TableLine("rests", "none: the bias is unknown", is_odd=True)
        return
    lengths_s = [rest.seconds for rest in rests]
    yield TableLine("rests", f"{len(rests)}: {sum(lengths_s):.1f} s in all, the longest {max(lengths_s):.1f} s")
    longest = sorted(rests, key=lambda rest: -rest.seconds)[:STRETCHES_SHOWN]
    yield from (_stretch(rest) for rest in sorted(longest, key=lambda rest: rest.start_s))
    if len(longest) < len(rests):
        means = [rest.mean_dps for rest in rests]
        words = f"mean rate {min(means):+.4f} … {max(means):+.4f} deg/s; --json has all of them"
        yield TableLine(f"all {len(rests)}", words)


def _stretch(rest: Stretch) -> TableLine:
    bias = f"mean rate {rest.mean_dps:+.4f} deg/s, standard deviation {rest.std_dps:.4f} deg/s"
    return TableLine(f"{rest.start_s:.1f} – {rest.end_s:.1f} s", bias, rest.std_dps > NOISY_DPS)


def _noise(allan: Allan | None) -> Iterator[TableLine]:
    if allan is None:
        yield TableLine("unknown", "no rest of 30 s to measure it in")
        return
    walk, instability_dps = allan.angle_random_walk_deg_rts, allan.bias_instability_dps
    yield TableLine("measured over", f"{allan.stretch.start_s:.1f} – {allan.stretch.end_s:.1f} s")
    white = "unknown: the Allan deviation has no slope of −1/2" if walk is None else random_walk_text(walk)
    yield TableLine("angle random walk", white)
    if instability_dps is None or allan.bias_instability_tau_s is None:
        yield TableLine("bias instability", "unknown: the rest is too short, or the noise is white")
        return
    averaging = f"at {allan.bias_instability_tau_s:.3g} s"
    yield TableLine("bias instability", f"{hourly_rate_text(instability_dps)} {averaging}")
    minimum = hourly_rate_text(FLICKER_FLOOR * instability_dps)
    yield TableLine("Allan minimum", f"{minimum}; bias instability is {FLICKER_WORDS}")


def _metadata(session: Session) -> Iterator[Group]:
    """Metadata of the file."""
    for name, table in session.metadata.items():
        lines = [TableLine(_printable(key), _first_line(text)) for key, text in table.items()]
        yield Group(f"metadata: {_printable(name)}", lines or [TableLine("empty", "")])


def _first_line(text: str) -> str:
    lines = text.splitlines() or [""]
    first = _printable(lines[0])
    short = first if len(first) <= TEXT_SHOWN else f"{first[: TEXT_SHOWN - 1]}…"
    return f"{short}  ({len(lines)} lines)" if len(lines) > 1 else short


def _printable(text: str) -> str:
    return "".join(letter if letter.isprintable() else "?" for letter in text)
