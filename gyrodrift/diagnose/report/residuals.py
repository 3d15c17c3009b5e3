"""What the difference looks like, in a report: rate errors against all they may depend on, over time, as a spectrum."""

from collections.abc import Sequence

from gyrodrift.diagnose.predictive_checks.dependences import Dependence
from gyrodrift.diagnose.predictive_checks.residual_series import ResidualSeries
from gyrodrift.diagnose.predictive_checks.spectra import Spectra
from gyrodrift.diagnose.report.figures import dependence_svgs, over_time_svgs, spectrum_svg
from gyrodrift.diagnose.report.text import marks, number
from gyrodrift.diagnose.result import Diagnosis
from gyrodrift.html.html import figure, panels, paragraph, section, span, text
from gyrodrift.html.numbers import significant

NAMED = 3
NEGLIGIBLE_DPS = 2e-3
"""RMS below which a dependence is practically negligible, deg/s: the relevance threshold of a bias that depends on
angle or direction, `features/history_columns.py`."""

CHANGE_POINTS_TOLD = 4
RANDOM = (
    "Some of what is named is random: the simulator's realisation is not that of the real thing, so that the two agree "
    "in kind and not second by second. What is unexplained below still holds it."
)


def residuals(diagnosis: Diagnosis) -> str:
    """The section."""
    checks, has_causes = diagnosis.residuals, bool(diagnosis.verdict.causes)
    is_random = any(cause.cause.is_random for cause in diagnosis.verdict.causes)
    return section(
        "What the difference looks like" if diagnosis.verdict.where else "What rate errors look like",
        paragraph(_introduction(diagnosis, checks.sessions)),
        paragraph(RANDOM if is_random else _depends(checks.dependences, has_causes=has_causes)),
        _dependence_figure(checks.dependences, has_causes=has_causes),
        _time_figure(checks.sessions, has_causes=has_causes),
        _spectrum_figure(checks.spectra, has_causes=has_causes),
    )


def _dependence_figure(every: Sequence[Dependence], *, has_causes: bool) -> str:
    if not every:
        return ""
    names = [_dependence_name(one, has_causes=has_causes) for one in every]
    return figure(
        _dependence_words(has_causes=has_causes), panels(names, dependence_svgs(every, has_causes=has_causes))
    )


def _time_figure(sessions: Sequence[ResidualSeries], *, has_causes: bool) -> str:
    names = [_session_name(one) for one in sessions]
    return figure(_time_words(has_causes=has_causes), panels(names, over_time_svgs(sessions, has_causes=has_causes)))


def _spectrum_figure(spectra: Sequence[Spectra], *, has_causes: bool) -> str:
    words = _spectrum_words(has_causes=has_causes)
    return figure(words, spectrum_svg(spectra, has_causes=has_causes)) if spectra else ""


def _introduction(diagnosis: Diagnosis, sessions: Sequence[ResidualSeries]) -> str:
    total = len(diagnosis.sessions)
    some = f" Drawn are {len(sessions)} of {total} sessions." if total > len(sessions) else ""
    return (
        "The rate error is the mean rate of a second less that of the encoder, without the bias of the session. Each "
        f"figure shows it as it was recorded, and as the simulator gives it on the same motion.{some}"
    )


def _depends(every: Sequence[Dependence], *, has_causes: bool) -> str:
    """On what the rate error depends more than the simulator's does."""
    left = sorted(((one.follows_dps, one.name) for one in every), reverse=True)
    told = [f"{text(name)}: {significant(dps, 2)} deg/s RMS" for dps, name in left[:NAMED] if dps > NEGLIGIBLE_DPS]
    what = "What is unexplained" if has_causes else "The difference"
    if not told:
        return f"<b>{what} depends on</b> nothing that is drawn here, by {NEGLIGIBLE_DPS:g} deg/s RMS or more."
    return f"<b>{what} depends on</b> {'; '.join(told)}. Each is taken by itself, the strongest first."


def _dependence_words(*, has_causes: bool) -> str:
    return (
        "<b>Rate error against what it may depend on.</b> Dots are seconds of the recordings, lines are medians. Below "
        "in each panel: recordings less simulator, enlarged, with the range of two standard errors. A line that stays "
        f"on 0 is explained.<br/>{marks(has_causes=has_causes)}"
    )


def _dependence_name(one: Dependence, *, has_causes: bool) -> str:
    amounts = f"{_dps(one.follows_before_dps)} → {_dps(one.follows_dps)}" if has_causes else _dps(one.follows_dps)
    return f"<strong>{text(one.name)}</strong><br/>{span(f'follows it: {amounts} deg/s RMS', 'note')}"


def _dps(value: float) -> str:
    return f"{value:.3f}" if value < 1.0 else significant(value, 3)


def _time_words(*, has_causes: bool) -> str:
    return (
        "<b>Rate error over time.</b> Medians of five seconds. Dotted: change points, where what is unexplained goes "
        f"from one level to another at once.<br/>{marks(has_causes=has_causes)}"
    )


def _session_name(session: ResidualSeries) -> str:
    name = f'<b title="{text(session.name)}">{session.number}. {text(session.name)}</b>'
    return name + span(_change_points(session), "note")


def _change_points(session: ResidualSeries) -> str:
    count = len(session.change_points)
    if not count:
        return "no change points"
    told = [
        f"{session.minutes[one.second]:.1f} min ({number(one.step_dps, 2)})"
        for one in session.change_points[:CHANGE_POINTS_TOLD]
    ]
    more = " …" if count > CHANGE_POINTS_TOLD else ""
    return f"{count} change point{'s' * (count > 1)}: {', '.join(told)}{more}"


def _spectrum_words(*, has_causes: bool) -> str:
    return (
        "<b>Spectrum of the rate error</b>, above half a hertz while it rests, or else turns steadily. Noise of the "
        "sensor is a level line; a bias that wanders rises to the left; a vibration is a peak."
        f"<br/>{marks(has_causes=has_causes, has_left=False)}"
    )
