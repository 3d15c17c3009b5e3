"""Tables of a report: negligible effects, detectable sizes, exports, base values, sessions; and the glossary."""

from collections.abc import Sequence
from math import floor, isfinite, log10
from typing import NamedTuple

from markupsafe import Markup

from gyrodrift.diagnose.export.files import FOLDER
from gyrodrift.diagnose.export.formats import FormatExport
from gyrodrift.diagnose.inference.gap import WORST_Z
from gyrodrift.diagnose.inference.verdict import NEGLIGIBLE_DEG
from gyrodrift.diagnose.report import text
from gyrodrift.diagnose.result import BaseValue, DiagnosedSession, Diagnosis
from gyrodrift.report.numbers import even, significant
from gyrodrift.report.page import Section, code
from gyrodrift.values.noise import ROOT_SECONDS_PER_ROOT_HOUR

TEMPLATES = "diagnose/report/templates"


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


def negligible(diagnosis: Diagnosis) -> Section | None:
    """The section of the negligible effects; None without such effects."""
    items = diagnosis.verdict.negligible
    values = {"items": items, "limit": NEGLIGIBLE_DEG, "words": text}
    return Section(f"{TEMPLATES}/negligible.html", values, "Real, but negligible") if items else None


def detectable(diagnosis: Diagnosis) -> Section:
    """The section of the detectable sizes."""
    values = {"diagnosis": diagnosis, "words": text}
    return Section(f"{TEMPLATES}/detectable.html", values, "The smallest effects these sessions would show")


def exported(exports: Sequence[FormatExport]) -> Section | None:
    """The section of the exports; None without exports."""
    return Section(f"{TEMPLATES}/exports.html", {"exports": exports, "folder": FOLDER}, "Exports") if exports else None


def calibration(diagnosis: Diagnosis) -> Section:
    """The section of base values of the rig."""
    rows = [_base_row(base_value) for base_value in diagnosis.calibration]
    heading = "Base values of the rig and of the recordings"
    return Section(f"{TEMPLATES}/calibration.html", {"rows": rows}, heading)


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
    name = Markup("{} {}").format(shown.name, code(base_value.name)).strip()
    return [name, *[*(text.fixed(value, decimals) for value in values), *[UNKNOWN] * 3][:4]]


def glossary() -> Section:
    """The section of the words used in a report."""
    return Section(f"{TEMPLATES}/glossary.html", {"limit": f"{WORST_Z:g}"}, "Words used here")


def sessions(diagnosis: Diagnosis) -> Section:
    """The section of the sessions, with the duration of the diagnosis."""
    values = {"rows": _session_rows(diagnosis.sessions), "seconds": significant(diagnosis.seconds, 3)}
    return Section(f"{TEMPLATES}/sessions.html", values, "The sessions")


def _session_rows(sessions: Sequence[DiagnosedSession]) -> list[list[str]]:
    numbers = [
        even([session.minutes for session in sessions]),
        even([session.sample_rate_hz for session in sessions]),
        even([session.bias_dps for session in sessions]),
        even([session.noise_dps_rthz for session in sessions]),
        even([session.noise_dps_rthz * ROOT_SECONDS_PER_ROOT_HOUR for session in sessions]),
    ]
    columns = zip(*numbers, strict=True)
    return [
        [f"{index}. {session.name}", *row, _has(session)]
        for index, (session, row) in enumerate(zip(sessions, columns, strict=True), 1)
    ]


def _has(session: DiagnosedSession) -> str:
    has = {
        "host times": session.has_host_times,
        "temperature": session.has_temperature,
        "counter": session.has_counter,
    }
    return ", ".join(name for name, is_there in has.items() if is_there) or "nothing"
