"""The end of a report: the rig beside the recordings, the recordings themselves, and what words mean."""

from math import floor, isfinite, log10
from typing import NamedTuple

from gyrodrift import __version__
from gyrodrift.diagnose.report.text import fixed, quiet
from gyrodrift.diagnose.result import BaseValue, DiagnosedSession, Diagnosis
from gyrodrift.html.html import command_line, facts, headings, paragraph, section, table, text
from gyrodrift.html.numbers import even, significant


class BaseUnit(NamedTuple):
    """How a base value is told to a person: its unit, how many of it the rig's own unit is, and most decimals."""

    unit: str
    times: float = 1.0
    decimals: int = 5


SHOWN = {
    "sample_rate_hz": BaseUnit("Hz", decimals=3),
    "noise_dps_rthz": BaseUnit("deg/s/√Hz"),
    "bias_dps": BaseUnit("deg/s", decimals=4),
    "host_delay_s": BaseUnit("ms", 1e3, 2),
    "host_jitter_s": BaseUnit("ms", 1e3, 2),
    "encoder_phase_deg": BaseUnit("deg", decimals=2),
}
UNKNOWN = "none seen"

GAP = (
    "The root mean square over all features of how many times chance each deviates, at most 20 each. Without a gap it "
    "is what the simulator scores against itself. Closed is how much of what lies above that went away."
)
HELD_OUT = (
    "Leave-one-session-out cross-validation: for each session in turn the causes are fitted on all others; it is "
    "judged by what they leave unexplained of it."
)
PROBABILITY = (
    "How sure it is that this effect acts: by what would be lost without it, and what others would do as well."
)
YAW = "The mean absolute difference of filtered yaw and encoder, with one set of filter parameters."
TRANSFER = (
    "Sim-to-real transfer, what the gap costs: the filter is tuned on simulated sessions or on real ones, and scored "
    "on real ones held out. Where all three numbers are alike, this gap needs no repair for tuning."
)
GLOSSARY = (
    ("Gap", GAP),
    ("Held out", HELD_OUT),
    ("Probability", PROBABILITY),
    ("Mean yaw error", YAW),
    ("Tuned on", TRANSFER),
)


def calibration(diagnosis: Diagnosis) -> str:
    """The section of base values of the rig."""
    rows = [_base_row(one) for one in diagnosis.calibration]
    words = (
        "These may differ from the rig's without being a fault of the simulator, and are no cause: bias, noise and "
        "sample rate, how late the host has a sample (delay) and by how much that scatters (jitter), and the angle at "
        "which the encoder begins (phase). They were fitted to each session first. Noise and bias are fitted through "
        "the rig with its effects: each is moved until the simulator, driven through the same motion, measures what "
        "was recorded. Copy them into the rig if it is to stand for this device. No delay is seen where the clocks of "
        "host and device have no common zero, and no jitter where arrivals do not scatter as behind a scheduler."
    )
    head = headings(["base value", "rig", "recordings", "least", "most"])
    return section("The rig beside the recordings", paragraph(words), table("Median of all sessions.", head, rows))


def _base_row(one: BaseValue) -> list[str]:
    """A base value of the rig, and those of the recordings."""
    shown = SHOWN.get(one.name, BaseUnit(""))
    known = [value * shown.times for value in (one.rig, one.data, one.low, one.high) if value is not None]
    sizes = [abs(value) for value in known if isfinite(value) and abs(value) >= 10.0**-shown.decimals]
    decimals = min(max(2 - floor(log10(max(sizes))), 0), shown.decimals) if sizes else 0
    unit = f" {quiet(shown.unit)}" if shown.unit else ""
    return [f"{text(one.name)}{unit}", *[*(fixed(value, decimals) for value in known), *[UNKNOWN] * 3][:4]]


def how_it_was_done(diagnosis: Diagnosis, command: str) -> str:
    """The last section."""
    done = [("Took", f"{significant(diagnosis.seconds, 3)} s"), ("Made by", f"gyrodrift {text(__version__)}")]
    return section("How it was done", facts([*GLOSSARY, *done]), _sessions(diagnosis), command_line(command))


def _sessions(diagnosis: Diagnosis) -> str:
    sessions = diagnosis.sessions
    numbers = [
        even([session.minutes for session in sessions]),
        even([session.sample_rate_hz for session in sessions]),
        even([session.bias_dps for session in sessions]),
        even([session.noise_dps_rthz for session in sessions]),
    ]
    columns = zip(*numbers, strict=True)
    rows = [
        [f"{at}. {text(session.name)}", *row, _has(session)]
        for at, (session, row) in enumerate(zip(sessions, columns, strict=True), 1)
    ]
    head = headings(["session", "minutes", "Hz", "bias, deg/s", "noise, deg/s/√Hz", "beside rate and angle"], words=1)
    return table("The sessions, with the numbers that they have in the figures.", head, rows, words=1)


def _has(session: DiagnosedSession) -> str:
    has = {
        "host times": session.has_host_times,
        "temperature": session.has_temperature,
        "counter": session.has_counter,
    }
    return ", ".join(name for name, is_there in has.items() if is_there) or "nothing"
