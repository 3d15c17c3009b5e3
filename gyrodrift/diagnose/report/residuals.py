"""What the difference looks like, in a report: rate errors against all they may depend on, over time, as a spectrum."""

from collections.abc import Sequence

from gyrodrift.diagnose.diagnosis import Diagnosis
from gyrodrift.diagnose.report.binned_medians import shape_dps
from gyrodrift.diagnose.report.figures import against_svgs, over_time_svgs, spectrum_svg
from gyrodrift.diagnose.report.regressors import Against, against
from gyrodrift.diagnose.report.residual_series import Seconds, seconds_of
from gyrodrift.diagnose.report.spectra import pooled
from gyrodrift.diagnose.report.text import marks, number
from gyrodrift.html.html import figure, panels, paragraph, section, span, text
from gyrodrift.html.numbers import significant

NAMED = 3
MATTERS_DPS = 2e-3
"""RMS below which a dependence is nobody's trouble, deg/s."""

JUMPS_TOLD = 4
RANDOM = (
    "Chance plays a part in what is named: the simulator's throws of the dice are not those of the real thing, so that "
    "the two agree in kind and not second by second. What is left over below still holds it."
)


def shape(diagnosis: Diagnosis) -> str:
    """The section."""
    sessions, has_causes = seconds_of(diagnosis), bool(diagnosis.verdict.causes)
    every = against(sessions)
    is_random = any(cause.cause.answer.candidate.realisations > 1 for cause in diagnosis.verdict.causes)
    return section(
        "What the difference looks like" if diagnosis.verdict.where else "What rate errors look like",
        paragraph(_introduction(diagnosis, sessions)),
        paragraph(RANDOM if is_random else _depends(every, has_causes=has_causes)),
        _against_figure(every, has_causes=has_causes),
        _time_figure(sessions, has_causes=has_causes),
        _spectrum_figure(sessions, has_causes=has_causes),
    )


def _against_figure(every: Sequence[Against], *, has_causes: bool) -> str:
    if not every:
        return ""
    names = [_against_name(one, has_causes=has_causes) for one in every]
    return figure(_against_words(has_causes=has_causes), panels(names, against_svgs(every, has_causes=has_causes)))


def _time_figure(sessions: Sequence[Seconds], *, has_causes: bool) -> str:
    names = [_session_name(one) for one in sessions]
    return figure(_time_words(has_causes=has_causes), panels(names, over_time_svgs(sessions, has_causes=has_causes)))


def _spectrum_figure(sessions: Sequence[Seconds], *, has_causes: bool) -> str:
    both = [pooled([one.slow for one in sessions]), pooled([one.quick for one in sessions])]
    spectra = [one for one in both if len(one.hz)]
    words = _spectrum_words(has_causes=has_causes)
    return figure(words, spectrum_svg(spectra, has_causes=has_causes)) if spectra else ""


def _introduction(diagnosis: Diagnosis, sessions: Sequence[Seconds]) -> str:
    total = len(diagnosis.sessions)
    some = f" Drawn are {len(sessions)} of {total} sessions." if total > len(sessions) else ""
    return (
        "The rate error is the mean rate of a second less that of the encoder, without the bias of the session. Each "
        f"figure shows it as it was recorded, and as the simulator gives it on the same motion.{some}"
    )


def _depends(every: Sequence[Against], *, has_causes: bool) -> str:
    """On what the rate error depends more than the simulator's does."""
    left = sorted(((shape_dps(one.x, one.left_dps), one.regressor.name) for one in every), reverse=True)
    told = [f"{text(name)}: {significant(dps, 2)} deg/s RMS" for dps, name in left[:NAMED] if dps > MATTERS_DPS]
    what = "What is left over" if has_causes else "The difference"
    if not told:
        return f"<b>{what} depends on</b> nothing that is drawn here."
    return f"<b>{what} depends on</b> {'; '.join(told)}. Each is taken by itself, the strongest first."


def _against_words(*, has_causes: bool) -> str:
    return (
        "<b>Rate error against what it may depend on.</b> Dots are seconds of the recordings, lines are medians. Below "
        "in each panel: recordings less simulator, enlarged, with the range of two standard errors. A line that stays "
        f"on 0 is explained.<br/>{marks(has_causes=has_causes)}"
    )


def _against_name(one: Against, *, has_causes: bool) -> str:
    before, left = shape_dps(one.x, one.real_dps - one.before_dps), shape_dps(one.x, one.left_dps)
    amounts = f"{_dps(before)} → {_dps(left)}" if has_causes else _dps(left)
    return f"<strong>{text(one.regressor.name)}</strong><br/>{span(f'follows it: {amounts} deg/s RMS', 'note')}"


def _dps(value: float) -> str:
    return f"{value:.3f}" if value < 1.0 else significant(value, 3)


def _time_words(*, has_causes: bool) -> str:
    return (
        "<b>Rate error over time.</b> Medians of five seconds. Dotted: where what is left over jumps from one level to "
        "another.<br/>"
        f"{marks(has_causes=has_causes)}"
    )


def _session_name(session: Seconds) -> str:
    name = f'<b title="{text(session.name)}">{session.number}. {text(session.name)}</b>'
    return name + span(_jumps(session), "note")


def _jumps(session: Seconds) -> str:
    count = len(session.jumps)
    if not count:
        return "no jumps"
    told = [
        f"{session.minutes[jump.second]:.1f} min ({number(jump.step_dps, 2)})" for jump in session.jumps[:JUMPS_TOLD]
    ]
    more = " …" if count > JUMPS_TOLD else ""
    return f"{count} jump{'s' * (count > 1)}: {', '.join(told)}{more}"


def _spectrum_words(*, has_causes: bool) -> str:
    return (
        "<b>Spectrum of the rate error</b>, above half a hertz while it rests, or else turns steadily. Noise of the "
        "sensor is a level line; a bias that wanders rises to the left; a vibration is a peak."
        f"<br/>{marks(has_causes=has_causes, has_left=False)}"
    )
