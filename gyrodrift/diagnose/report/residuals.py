"""Rate errors in a report: against the quantities that they may depend on, over time, and as spectra."""

from markupsafe import Markup

from gyrodrift.diagnose.features.vector import FEATURES, NUMBER
from gyrodrift.diagnose.predictive_checks.rate_errors import RATE, Dependence
from gyrodrift.diagnose.report.charts import dependence_chart, over_time_chart, spectrum_chart
from gyrodrift.diagnose.report.text import marks
from gyrodrift.diagnose.result import Diagnosis
from gyrodrift.report.numbers import significant
from gyrodrift.report.page import Section, marked, titled

NAMED = 3
"""Largest number of dependences in the introduction. Chosen: more make a sentence hard to read."""

NEGLIGIBLE_DPS = FEATURES[NUMBER["direction"]].threshold
"""RMS below which a dependence is practically negligible, deg/s: that of a bias that depends on the direction."""


def residuals(diagnosis: Diagnosis) -> Section:
    """The section of the rate errors."""
    checks, has_causes = diagnosis.rate_errors, bool(diagnosis.verdict.causes)
    by_size = sorted(((item.after_dps, item.name) for item in checks.dependences), reverse=True)
    values = {
        "has_causes": has_causes,
        "is_random": any(cause.cause.is_random for cause in diagnosis.verdict.causes),
        "drawn": len(checks.sessions),
        "total": len(diagnosis.sessions),
        "negligible": f"{NEGLIGIBLE_DPS:g}",
        "strongest": [
            f"{name}: {significant(dps, 2)} deg/s RMS" for dps, name in by_size[:NAMED] if dps > NEGLIGIBLE_DPS
        ],
        "dependences": [
            (dependence_name(item, has_causes=has_causes), dependence_chart(item, has_causes=has_causes))
            for item in checks.dependences
            if item.name != RATE
        ],
        "over_time": [
            (
                titled(series.name, f"{series.minutes[-1]:.1f} min", f"{series.number}. "),
                over_time_chart(series, has_causes=has_causes),
            )
            for series in checks.sessions
        ],
        "spectra": [
            (Markup("<strong>At rest</strong>"), spectrum_chart(spectra, has_causes=has_causes))
            for spectra in (checks.spectra,)
            if spectra is not None
        ],
        "marks": marks(has_causes=has_causes),
        "switches": marks(has_causes=has_causes, is_switched=True),
        "spectrum_switches": marks(has_causes=has_causes, is_switched=True, has_residual=False),
    }
    heading = "What the difference looks like" if diagnosis.verdict.where else "What the rate errors look like"
    return Section("diagnose/report/templates/residuals.html", values, heading)


def dependence_name(dependence: Dependence, *, has_causes: bool) -> Markup:
    """Name of the chart of a regressor."""
    before = f"{_dps(dependence.before_dps)} → " if has_causes else ""
    note = f"part of the residual that follows it: {before}{_dps(dependence.after_dps)} deg/s RMS"
    return Markup("<strong>{}</strong><br/>{}").format(dependence.name, marked("note", note))


def _dps(value: float) -> str:
    return f"{value:.3f}" if value < 1.0 else significant(value, 3)
