"""The rate errors in a report: against the quantities that they may depend on, over time, and as spectra."""

from collections.abc import Sequence

from gyrodrift.diagnose.predictive_checks.residual_checks import Dependence
from gyrodrift.diagnose.predictive_checks.residual_series import ResidualSeries, Spectra
from gyrodrift.diagnose.report.figures import dependence_svgs, over_time_svgs, spectrum_svgs
from gyrodrift.diagnose.report.text import NAMES, marks, number, switched_marks
from gyrodrift.diagnose.result import Diagnosis
from gyrodrift.html.html import figure, panels, paragraph, section, span, text
from gyrodrift.html.numbers import significant

NAMED = 3
"""Largest number of dependences in the introduction."""

RATE = "rate"
"""Name of the regressor of the figure at the top of the page."""

NEGLIGIBLE_DPS = 2e-3
"""RMS below which a dependence is practically negligible, deg/s: the relevance threshold of a bias that depends on
angle or direction, `features/columns.py`."""

MOST_CHANGE_POINTS = 4
"""Largest number of change points that are listed for a session."""

RANDOM = (
    "A named cause is random: the simulator draws a course of its own, so that it agrees with the recordings in its "
    "statistics and not second by second. The residual still holds it."
)


def residuals(diagnosis: Diagnosis) -> str:
    """The section of the rate errors."""
    checks, has_causes = diagnosis.residuals, bool(diagnosis.verdict.causes)
    is_random = any(cause.cause.is_random for cause in diagnosis.verdict.causes)
    return section(
        "What the difference looks like" if diagnosis.verdict.where else "What the rate errors look like",
        paragraph(_introduction(diagnosis, checks.sessions)),
        paragraph(RANDOM if is_random else _depends(checks.dependences, has_causes=has_causes)),
        _dependence_figure(checks.dependences, has_causes=has_causes),
        _time_figure(checks.sessions, has_causes=has_causes),
        _spectrum_figure(checks.spectra, has_causes=has_causes),
    )


def rate_figure(diagnosis: Diagnosis) -> str:
    """The figure of the rate error against the rate; empty if no session moves."""
    has_causes = bool(diagnosis.verdict.causes)
    against_rate = [dependence for dependence in diagnosis.residuals.dependences if dependence.name == RATE]
    if not against_rate:
        return ""
    caption = (
        "<b>Rate error against rate.</b> A slope is a scale error, a level is a bias, a bend is a nonlinearity. Below, "
        f"on a scale of its own, the residual.<br/>{marks(has_causes=has_causes)}"
    )
    names = [_dependence_name(dependence, has_causes=has_causes) for dependence in against_rate]
    return figure(caption, panels(names, dependence_svgs(against_rate, has_causes=has_causes, name="rate-error")))


def _dependence_figure(every: Sequence[Dependence], *, has_causes: bool) -> str:
    """The figure of the other regressors; the rate has its own figure."""
    every = [series for series in every if series.name != RATE]
    if not every:
        return ""
    names = [_dependence_name(series, has_causes=has_causes) for series in every]
    return figure(
        _dependence_words(has_causes=has_causes), panels(names, dependence_svgs(every, has_causes=has_causes))
    )


def _time_figure(sessions: Sequence[ResidualSeries], *, has_causes: bool) -> str:
    names = [_session_name(series) for series in sessions]
    return figure(_time_words(has_causes=has_causes), panels(names, over_time_svgs(sessions, has_causes=has_causes)))


def _spectrum_figure(spectra: Sequence[Spectra], *, has_causes: bool) -> str:
    words = _spectrum_words(has_causes=has_causes)
    names = [
        f"<strong>{significant(panel.hz[0], 2)} to {significant(panel.hz[-1], 2)} Hz</strong>" for panel in spectra
    ]
    return figure(words, panels(names, spectrum_svgs(spectra, has_causes=has_causes))) if spectra else ""


def _introduction(diagnosis: Diagnosis, sessions: Sequence[ResidualSeries]) -> str:
    total = len(diagnosis.sessions)
    some = f" {len(sessions)} of {total} sessions are drawn." if total > len(sessions) else ""
    simulated = f"{NAMES[1]} and from the {NAMES[2]}" if diagnosis.verdict.causes else "simulator"
    return (
        "The rate error is the rate of the gyro minus that of the encoder, each averaged over a second, without the "
        f"mean bias of the session. Each figure shows it from the recordings and, for the same motion, from the "
        f"{simulated}. The residual is what remains: recordings minus simulator.{some}"
    )


def _depends(every: Sequence[Dependence], *, has_causes: bool) -> str:
    """The strongest dependences of the residual, in a sentence."""
    by_size = sorted(((dependence.trend_dps, dependence.name) for dependence in every), reverse=True)
    strongest = [
        f"{text(name)}: {significant(dps, 2)} deg/s RMS" for dps, name in by_size[:NAMED] if dps > NEGLIGIBLE_DPS
    ]
    what = f"The residual of the {NAMES[2]}" if has_causes else "The residual"
    if not strongest:
        return f"<b>{what} depends on</b> nothing that is drawn here by more than {NEGLIGIBLE_DPS:g} deg/s RMS."
    return f"<b>{what} depends on</b> {'; '.join(strongest)}. Each is taken by itself, the strongest first."


def _dependence_words(*, has_causes: bool) -> str:
    return (
        "<b>Rate error against what it may depend on.</b> Gray dots are single seconds of the recordings, lines are "
        "medians. Below, on a scale of its own, the residual, with ± 2 standard errors as a band: where the band holds "
        f"0, the residual does not depend on it.<br/>{marks(has_causes=has_causes)}"
    )


def _dependence_name(dependence: Dependence, *, has_causes: bool) -> str:
    amounts = (
        f"{_dps(dependence.trend_before_dps)} → {_dps(dependence.trend_dps)}"
        if has_causes
        else _dps(dependence.trend_dps)
    )
    follows = span(f"part of the residual that follows it: {amounts} deg/s RMS", "note")
    return f"<strong>{text(dependence.name)}</strong><br/>{follows}"


def _dps(value: float) -> str:
    return f"{value:.3f}" if value < 1.0 else significant(value, 3)


def _time_words(*, has_causes: bool) -> str:
    return (
        "<b>Rate error over time</b>, as medians of five seconds. Below, on a scale of its own, the residual; a dotted "
        "line marks a change point, where it jumps from one level to another (by so many deg/s)."
        f"<br/>{switched_marks(has_causes=has_causes)}"
    )


def _session_name(series: ResidualSeries) -> str:
    name = f'<b title="{text(series.name)}">{series.number}. {text(series.name)}</b>'
    return name + span(_change_points(series), "note")


def _change_points(series: ResidualSeries) -> str:
    count = len(series.change_points)
    if not count:
        return "no change points"
    listed = [
        f"{series.minutes[change_point.second]:.1f} min ({number(change_point.step_dps, 2)})"
        for change_point in series.change_points[:MOST_CHANGE_POINTS]
    ]
    rest = " …" if count > MOST_CHANGE_POINTS else ""
    return f"{count} change point{'s' * (count > 1)}: {', '.join(listed)}{rest}"


def _spectrum_words(*, has_causes: bool) -> str:
    return (
        "<b>Amplitude spectral density of the rate error.</b> Above 0.5 Hz it is measured while the device rests, or "
        "else turns steadily. White noise of the sensor is a level line, a wandering bias rises to the left, a "
        f"vibration is a peak.<br/>{switched_marks(has_causes=has_causes, has_left=False)}"
    )
