"""The description of a session as text: groups of lines, and a ! in front of what is worth a second look."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from gyrodrift.describe.possible import impossible_values
from gyrodrift.describe.values import Allan, HostClock, RestSource, SessionDescription
from gyrodrift.session.checks.finding import SessionFinding
from gyrodrift.session.mcap.raw import RawSize
from gyrodrift.session.session import Session

STRETCHES_SHOWN = 6
TEXT_SHOWN = 90

JITTER_ODD = 0.1
"""Scatter of the time steps, in periods, from which on it is worth a look."""
DRIFT_ODD_PPM = 1000.0
"""Yaw is off by as much as the clock: a tenth of a percent."""
DRIFT_ROUGH_PPM = 5.0
DRIFT_DOUBT_PPM = 100.0
"""A standard error of that size says that the clocks are not related by a line: one of them stepped."""
DELAY_ODD_S = 0.1
LOUD_DPS = 2.0
"""No gyro at rest scatters by that much: the encoder was off, or the table shook."""


class TableLine(NamedTuple):
    """A line of the table; what is odd is marked."""

    name: str
    value: str
    is_odd: bool = False


class Group(NamedTuple):
    """Lines under a heading."""

    heading: str
    lines: list[TableLine]


def lines_of(groups: Sequence[Group]) -> Iterator[str]:
    """The lines of the table."""
    width = max(len(line.name) for group in groups for line in group.lines)
    for heading, lines in groups:
        yield from ("", heading)
        for name, value, is_odd in lines:
            yield f"{'!' if is_odd else ' '} {name:{width}}  {value}"


def groups_of(
    session: Session,
    description: SessionDescription,
    raw: RawSize | None = None,
    findings: Sequence[SessionFinding] = (),
) -> list[Group]:
    """All that is told of a session, with what was kept beside the samples at its end.

    `raw` is of its link's bytes, `findings` are those of the checks that contradict what it is taken for.
    """
    checked = [TableLine(finding.id, str(finding), is_odd=True) for finding in findings]
    checks = [Group("checks", checked)] if checked else []
    wrong = [TableLine(each.column, str(each), is_odd=True) for each in impossible_values(session)]
    impossible = [Group("impossible values, left out below", wrong)] if wrong else []
    return [*checks, *impossible, *_groups(description), Group("bytes of the link", [_raw(raw)]), *_kept(session)]


def _raw(raw: RawSize | None) -> TableLine:
    if raw is None:
        return TableLine("raw", "none kept; record --raw keeps them")
    return TableLine("raw", f"{raw.reads} reads, {raw.total_bytes / 1000.0:.4g} kB; replay --raw plays them again")


def _groups(description: SessionDescription) -> Iterator[Group]:
    yield Group("samples", list(_samples(description)))
    yield Group("host clock", list(_host(description.host)))
    yield Group("values", list(_values(description)))
    by = {
        RestSource.ENCODER: "still, by the encoder",
        RestSource.RATE: "steady: a guess by the rate alone, a constant spin looks the same",
    }
    yield Group(by[description.still_by], list(_stretches(description)))
    yield Group("noise", list(_noise(description.allan)))


def _samples(description: SessionDescription) -> Iterator[TableLine]:
    yield TableLine("samples", str(description.samples))
    yield TableLine("duration", f"{description.duration_s:.6g} s")
    if description.rate_hz is None or description.jitter_s is None:
        yield TableLine("rate", "unknown: device time never goes forward", is_odd=True)
    else:
        yield TableLine("rate", f"{description.rate_hz:.6g} Hz")
        is_odd = description.jitter_s * description.rate_hz > JITTER_ODD
        yield TableLine("jitter", f"{_milliseconds(description.jitter_s)}, scatter of the time steps", is_odd)
    gaps = description.gaps
    missing = f": {gaps.missing} samples missing" if gaps.count or gaps.missing else ""
    longest = f", the longest gap {gaps.longest_s:.3g} s" if gaps.count else ""
    yield TableLine("gaps", f"{gaps.count or 'none'}{missing}{longest}", bool(missing))
    if description.steps_not_forward:
        yield TableLine(
            "time", f"{description.steps_not_forward} steps do not go forward; the filter passes them by", is_odd=True
        )
    if description.rates_not_finite:
        yield TableLine(
            "rates", f"{description.rates_not_finite} are no number; the filter passes them by", is_odd=True
        )


def _milliseconds(seconds: float) -> str:
    return f"{round(1e3 * seconds, 6):.3g} ms"


def _host(host: HostClock | None) -> Iterator[TableLine]:
    if host is None:
        yield TableLine("arrival", "not recorded")
        return
    if host.drift_ppm is None or host.drift_sd_ppm is None:
        yield TableLine("drift", "unknown: too short to say")
    else:
        is_odd = abs(host.drift_ppm) > DRIFT_ODD_PPM or host.drift_sd_ppm > DRIFT_DOUBT_PPM
        digits = 0 if host.drift_sd_ppm > DRIFT_ROUGH_PPM else 2
        drift = f"{host.drift_ppm:.{digits}f} ± {host.drift_sd_ppm:.{digits}f}"
        uneven = "; too uneven for a drift, so one of them may have been set" * (host.drift_sd_ppm > DRIFT_DOUBT_PPM)
        yield TableLine("drift", f"{drift} ppm, clock of the device against the host's{uneven}", is_odd)
    late = f"95 of 100 samples within {_milliseconds(host.delay_p95_s)} of the soonest possible"
    yield TableLine("delay", late, host.delay_p95_s > DELAY_ODD_S)


def _values(description: SessionDescription) -> Iterator[TableLine]:
    if description.rate is None:
        yield TableLine("rate", "not one that is a number", is_odd=True)
    else:
        low, high, mean = description.rate.min_dps, description.rate.max_dps, description.rate.mean_dps
        stuck = ": never changes" if low == high and description.samples > 1 else ""
        yield TableLine("rate", f"{low:.6g} … {high:.6g} deg/s, mean {mean:.4g} deg/s{stuck}", bool(stuck))
    encoder, temperature = description.encoder, description.temperature
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


def _stretches(description: SessionDescription) -> Iterator[TableLine]:
    """All in one line, then the longest in order of time."""
    stretches = description.stretches
    if not stretches:
        yield TableLine("stretches", "none: the bias cannot be told", is_odd=True)
        return
    lengths_s = [one.end_s - one.start_s for one in stretches]
    yield TableLine("stretches", f"{len(stretches)}: {sum(lengths_s):.1f} s in all, the longest {max(lengths_s):.1f} s")
    shown = sorted(
        sorted(stretches, key=lambda one: one.start_s - one.end_s)[:STRETCHES_SHOWN], key=lambda o: o.start_s
    )
    for one in shown:
        bias = f"mean rate {one.mean_dps:+.4f} deg/s, standard deviation {one.std_dps:.4f} deg/s"
        yield TableLine(f"{one.start_s:.1f} – {one.end_s:.1f} s", bias, one.std_dps > LOUD_DPS)
    if len(shown) < len(stretches):
        means = [one.mean_dps for one in stretches]
        yield TableLine(
            f"all {len(stretches)}", f"mean rate {min(means):+.4f} … {max(means):+.4f} deg/s; each is in --json"
        )


def _noise(allan: Allan | None) -> Iterator[TableLine]:
    if allan is None:
        yield TableLine("unknown", "there is no stretch of 30 s without motion to measure it over")
        return
    walk, floor, tau_s = allan.angle_random_walk_deg_rts, allan.bias_instability_dps, allan.bias_instability_tau_s
    yield TableLine("measured over", f"{allan.stretch.start_s:.1f} – {allan.stretch.end_s:.1f} s")
    white = "no slope of −1/2 to read it from" if walk is None else f"{walk:.4g} deg/√s"
    yield TableLine("angle random walk", white)
    flicker = "none seen: the stretch is too short, or the noise is white"
    yield TableLine(
        "bias instability", flicker if floor is None or tau_s is None else f"{floor:.3g} deg/s at {tau_s:.3g} s"
    )


def _kept(session: Session) -> Iterator[Group]:
    """What was kept beside the samples."""
    for name, table in session.metadata.items():
        lines = [TableLine(_printable(key), _first_line(text)) for key, text in table.items()]
        yield Group(f"kept: {_printable(name)}", lines or [TableLine("empty", "")])


def _first_line(text: str) -> str:
    lines = text.splitlines() or [""]
    first = _printable(lines[0])
    short = first if len(first) <= TEXT_SHOWN else f"{first[: TEXT_SHOWN - 1]}…"
    return f"{short}  ({len(lines)} lines)" if len(lines) > 1 else short


def _printable(text: str) -> str:
    return "".join(letter if letter.isprintable() else "?" for letter in text)
