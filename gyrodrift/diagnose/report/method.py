"""The base values of rig and recordings, the sessions, and the glossary of a report."""

from collections.abc import Sequence
from math import floor, isfinite, log10
from typing import NamedTuple

from gyrodrift.diagnose.inference.gap import WORST_Z
from gyrodrift.diagnose.report.text import fixed
from gyrodrift.diagnose.result import BaseValue, DiagnosedSession, Diagnosis
from gyrodrift.html.html import facts, headings, paragraph, section, table, text
from gyrodrift.html.numbers import even, significant
from gyrodrift.values.noise import ROOT_SECONDS_PER_ROOT_HOUR


class BaseUnit(NamedTuple):
    """Presentation of a base value: name with unit, factor from the unit of the rig, and largest number of decimals."""

    name: str
    times: float = 1.0
    decimals: int = 5


SHOWN = {
    "sample_rate_hz": BaseUnit("sample rate, Hz", decimals=3),
    "noise_dps_rthz": BaseUnit("white noise, deg/s/√Hz"),
    "bias_dps": BaseUnit("bias, deg/s", decimals=4),
    "host_delay_s": BaseUnit("delay until the host has a sample, ms", 1e3, 2),
    "host_jitter_s": BaseUnit("scatter of that delay (jitter), ms", 1e3, 2),
    "encoder_phase_deg": BaseUnit("encoder angle at the start (phase), deg", decimals=2),
}
UNKNOWN = "none seen"

RIG = (
    "The description of the simulator, a YAML file: base values of the gyro and the encoder, and effects such as "
    "<code>scale_factor</code>."
)
CORRECTED = (
    "The rig with the named causes switched on at their fitted sizes. <code>rig.yaml</code> has the causes with a "
    "probability of 0.5 or more."
)
GAP = (
    f"The root mean square of the deviations of all features in σ, each limited to {WORST_Z:g} σ. The simulator "
    "against itself shows the part of chance alone. Closed is the share of the rest that the correction removes."
)
HELD_OUT = (
    "Leave-one-session-out cross-validation: for each session, the sizes of the causes are fitted on all other "
    "sessions. The gap after the correction is the residual of such predictions."
)
PROBABILITY = (
    "Posterior probability that the effect acts: the weight of all sets of effects that hold it. Sets compete with the "
    "simulator as it is, with all other sets, and with something unknown."
)
YAW = (
    "The mean absolute difference between filtered yaw and encoder, with the filter parameters that were tuned in the "
    "simulator as it is."
)
TRANSFER = (
    "Sim-to-real transfer, what the gap costs: the filter is tuned on simulated sessions, or on recordings, and scored "
    "on other recordings. Where all numbers are alike, tuning in the simulator loses nothing by the gap."
)
GLOSSARY = (
    ("Rig", RIG),
    ("Corrected simulator", CORRECTED),
    ("Sim-to-real gap", GAP),
    ("Held-out sessions", HELD_OUT),
    ("Probability", PROBABILITY),
    ("Mean absolute yaw error", YAW),
    ("Filter tuned in simulation", TRANSFER),
)


def calibration(diagnosis: Diagnosis) -> str:
    """The section of base values of the rig."""
    rows = [_base_row(base_value) for base_value in diagnosis.calibration]
    words = (
        "These values differ from device to device and from day to day. They were fitted to each session first, so "
        "that they are no cause of the gap. Noise and bias were moved until the simulator measures the recorded "
        "values. Copy the values of the recordings into the rig if it should represent this device. The delay is "
        "known only if the clocks of host and device have a common zero. The jitter is known if arrivals scatter as "
        "they do behind a scheduler of the host."
    )
    head = headings(["base value", "rig", "recordings, median", "least", "most"])
    return section(
        "Base values of the rig and of the recordings", paragraph(words), table("Over all sessions.", head, rows)
    )


def _base_row(base_value: BaseValue) -> list[str]:
    """Row of a base value in the table."""
    shown = SHOWN.get(base_value.name, BaseUnit(""))
    values = [
        value * shown.times
        for value in (base_value.rig, base_value.data, base_value.low, base_value.high)
        if value is not None
    ]
    sizes = [abs(value) for value in values if isfinite(value) and abs(value) >= 10.0**-shown.decimals]
    decimals = min(max(2 - floor(log10(max(sizes))), 0), shown.decimals) if sizes else 0
    key = f"<code>{text(base_value.name)}</code>"
    return [f"{shown.name} {key}".strip(), *[*(fixed(value, decimals) for value in values), *[UNKNOWN] * 3][:4]]


def words_used() -> str:
    """The section of the glossary."""
    return section("Words used here", facts(GLOSSARY))


def sessions(diagnosis: Diagnosis) -> str:
    """The section of the sessions, with the duration of the diagnosis."""
    took = f"The diagnosis took {significant(diagnosis.seconds, 3)} s."
    return section("The sessions", _table(diagnosis.sessions), paragraph(took))


def _table(sessions: Sequence[DiagnosedSession]) -> str:
    numbers = [
        even([session.minutes for session in sessions]),
        even([session.sample_rate_hz for session in sessions]),
        even([session.bias_dps for session in sessions]),
        even([session.noise_dps_rthz for session in sessions]),
        even([session.noise_dps_rthz * ROOT_SECONDS_PER_ROOT_HOUR for session in sessions]),
    ]
    columns = zip(*numbers, strict=True)
    rows = [
        [f"{index}. {text(session.name)}", *row, _has(session)]
        for index, (session, row) in enumerate(zip(sessions, columns, strict=True), 1)
    ]
    head = headings(
        ["session", "minutes", "Hz", "bias, deg/s", "noise, deg/s/√Hz", "angle random walk, °/√h", "also holds"],
        words=1,
    )
    return table("Numbered as in the figures.", head, rows, words=1)


def _has(session: DiagnosedSession) -> str:
    has = {
        "host times": session.has_host_times,
        "temperature": session.has_temperature,
        "counter": session.has_counter,
    }
    return ", ".join(name for name, is_there in has.items() if is_there) or "nothing"
