"""Tell what recorded sessions hold: rate, gaps, clocks, temperature, rest and the noise there.

What is worth a second look has a ! in front. Bias and noise are those of the stretches in which the device stood still:
by the encoder, or, without one, where the rate is steady, which a constant spin is as well. Times of stretches are s
after the first sample. --picture needs pip install 'gyrodrift[lab]'.
"""

import argparse
import dataclasses
import json
from collections.abc import Iterator, Mapping
from enum import Enum
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from gyrodrift.errors import UsageError

if TYPE_CHECKING:
    from gyrodrift.describe.values import Allan, HostClock, SessionFacts
    from gyrodrift.session.session import Session

PICTURES = (".png", ".svg", ".pdf")
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


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument(
        "sessions",
        type=Path,
        nargs="+",
        metavar="SESSION",
        help="recorded session (.mcap or .csv), or a folder of them",
    )
    parser.add_argument("--json", action="store_true", help="a JSON object a session instead, on one line")
    parser.add_argument("--picture", type=Path, metavar="FILE", help="draw the session (.png, .svg or .pdf)")


def run(arguments: argparse.Namespace) -> int:
    """Describe each session; 0 when all are told."""
    from gyrodrift.describe.describe import describe
    from gyrodrift.session.files import load_session, session_paths

    paths = session_paths(arguments.sessions)
    if arguments.picture is not None:
        _check_picture(arguments.picture, len(paths))
    for number, path in enumerate(paths):
        session = load_session(path)
        facts = describe(session)
        if arguments.json:
            about = {"session": str(path), **_plain(facts), "metadata": _plain(session.metadata)}
            print(json.dumps(about, allow_nan=False, ensure_ascii=False))
        else:
            print(*[""] * (number > 0), path, *_table([*_groups(facts), *_kept(session)]), sep="\n")
        if arguments.picture is not None:
            _draw(session, facts, arguments.picture)
    return 0


def _check_picture(path: Path, sessions: int) -> None:
    if path.suffix not in PICTURES:
        raise UsageError(f"--picture {path}: expected a name that ends in {', '.join(PICTURES)}")
    if sessions > 1:
        raise UsageError(f"--picture shows one session, {sessions} were given")
    try:
        import matplotlib as mpl  # noqa: F401 - asked for before the session is read
    except ImportError as error:
        raise UsageError("--picture needs matplotlib: pip install 'gyrodrift[lab]'") from error


def _draw(session: "Session", facts: "SessionFacts", path: Path) -> None:
    from gyrodrift.describe.picture import draw
    from gyrodrift.files import whole_file

    with whole_file(path) as file:
        draw(session, facts, file, path.suffix.removeprefix("."))


def _plain(value: Any) -> dict[str, object]:
    """A dataclass or a mapping as JSON has it: null for what is no finite number."""
    named = value if isinstance(value, Mapping) else {f.name: getattr(value, f.name) for f in dataclasses.fields(value)}
    return {str(name): _plain_value(one) for name, one in named.items()}


def _plain_value(value: object) -> object:
    match value:
        case float():
            return value if isfinite(value) else None
        case None | int() | str():
            return value
        case Enum():
            return value.value
        case tuple() | list():
            return [_plain_value(one) for one in value]
        case _ if hasattr(value, "tolist"):
            return _plain_value(value.tolist())
        case _:
            return _plain(value)


def _table(groups: list[Group]) -> Iterator[str]:
    width = max(len(line.name) for group in groups for line in group.lines)
    for heading, lines in groups:
        yield from ("", heading)
        for name, value, is_odd in lines:
            yield f"{'!' if is_odd else ' '} {name:{width}}  {value}"


def _groups(facts: "SessionFacts") -> Iterator[Group]:
    yield Group("samples", list(_samples(facts)))
    yield Group("host clock", list(_host(facts.host)))
    yield Group("values", list(_values(facts)))
    by = {
        "encoder": "still, by the encoder",
        "rate": "steady: a guess by the rate alone, a constant spin looks the same",
    }
    yield Group(by[facts.still_by.value], list(_stretches(facts)))
    yield Group("noise", list(_noise(facts.allan)))


def _samples(facts: "SessionFacts") -> Iterator[TableLine]:
    yield TableLine("samples", str(facts.samples))
    yield TableLine("duration", f"{facts.duration_s:.6g} s")
    if facts.rate_hz is None or facts.jitter_s is None:
        yield TableLine("rate", "unknown: device time never goes forward", is_odd=True)
    else:
        yield TableLine("rate", f"{facts.rate_hz:.6g} Hz")
        is_odd = facts.jitter_s * facts.rate_hz > JITTER_ODD
        yield TableLine("jitter", f"{_milliseconds(facts.jitter_s)}, scatter of the time steps", is_odd)
    gaps = facts.gaps
    missing = f", {gaps.missing} samples missing" if gaps.count or gaps.missing else ""
    longest = f", longest {gaps.longest_s:.3g} s" if gaps.count else ""
    yield TableLine("gaps", f"{gaps.count}{missing}{longest}", bool(missing))
    if facts.steps_not_forward:
        yield TableLine(
            "time", f"{facts.steps_not_forward} steps do not go forward; the filter passes them by", is_odd=True
        )
    if facts.rates_not_finite:
        yield TableLine("rates", f"{facts.rates_not_finite} are no number; the filter passes them by", is_odd=True)


def _milliseconds(seconds: float) -> str:
    return f"{round(1e3 * seconds, 6):.3g} ms"


def _host(host: "HostClock | None") -> Iterator[TableLine]:
    if host is None:
        yield TableLine("arrival", "not recorded")
        return
    if host.drift_ppm is None or host.drift_sd_ppm is None:
        yield TableLine("drift", "unknown: too short to say")
    else:
        is_odd = abs(host.drift_ppm) > DRIFT_ODD_PPM or host.drift_sd_ppm > DRIFT_DOUBT_PPM
        digits = 0 if host.drift_sd_ppm > DRIFT_ROUGH_PPM else 2
        drift = f"{host.drift_ppm:.{digits}f} ± {host.drift_sd_ppm:.{digits}f}"
        yield TableLine("drift", f"{drift} ppm, device against host", is_odd)
    late = f"95 of 100 samples within {_milliseconds(host.delay_p95_s)} of the soonest possible"
    yield TableLine("delay", late, host.delay_p95_s > DELAY_ODD_S)


def _values(facts: "SessionFacts") -> Iterator[TableLine]:
    if facts.rate is None:
        yield TableLine("rate", "not one that is a number", is_odd=True)
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


def _stretches(facts: "SessionFacts") -> Iterator[TableLine]:
    """All in one line, then the longest in order of time."""
    stretches = facts.stretches
    if not stretches:
        yield TableLine("stretches", "none: the bias cannot be told", is_odd=True)
        return
    lengths_s = [one.end_s - one.start_s for one in stretches]
    yield TableLine("stretches", f"{len(stretches)}, {sum(lengths_s):.1f} s in all, longest {max(lengths_s):.1f} s")
    shown = sorted(
        sorted(stretches, key=lambda one: one.start_s - one.end_s)[:STRETCHES_SHOWN], key=lambda o: o.start_s
    )
    for one in shown:
        bias = f"{one.mean_dps:+.4f} deg/s, scatter {one.std_dps:.4f}"
        yield TableLine(f"{one.start_s:.1f} – {one.end_s:.1f} s", bias, one.std_dps > LOUD_DPS)
    if len(shown) < len(stretches):
        means = [one.mean_dps for one in stretches]
        yield TableLine(f"all {len(stretches)}", f"{min(means):+.4f} … {max(means):+.4f} deg/s; each is in --json")


def _noise(allan: "Allan | None") -> Iterator[TableLine]:
    if allan is None:
        yield TableLine("unknown", "no stretch of 30 s without motion")
        return
    walk, floor, tau_s = allan.angle_random_walk_deg_rts, allan.bias_instability_dps, allan.bias_instability_tau_s
    yield TableLine("over", f"{allan.stretch.start_s:.1f} – {allan.stretch.end_s:.1f} s")
    white = "no slope of −1/2 to read it from" if walk is None else f"{walk:.4g} deg/√s"
    yield TableLine("random walk", white)
    flicker = "none seen: the stretch is too short, or the noise is white"
    yield TableLine("instability", flicker if floor is None or tau_s is None else f"{floor:.3g} deg/s at {tau_s:.3g} s")


def _kept(session: "Session") -> Iterator[Group]:
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
