"""Panels of a session: none is empty, and no scale is so narrow that noise looks like drift."""

import numpy as np
import pytest

from gyrodrift.describe.drawing import DescribedSession, Panel
from gyrodrift.describe.recording_panels import recording_panels
from gyrodrift.describe.yaw import yaw_history_of
from gyrodrift.describe.yaw_panels import error_panel, histogram_panel, yaw_panels
from gyrodrift.facts.session_facts import SessionFacts
from gyrodrift.filters.registry import FILTERS
from gyrodrift.filters.run import FilterRun
from gyrodrift.report.chart import Shape
from gyrodrift.session.session import Session

T_S = np.arange(4000) / 100.0
NOISE_DPS = np.random.default_rng(1).normal(0.0, 0.01, len(T_S))


def panels_of(session: Session) -> dict[str, Panel]:
    chosen = FILTERS["restlevel"]
    described = DescribedSession(
        session, SessionFacts(session), yaw_history_of(session, FilterRun(chosen, chosen.params()))
    )
    by_encoder = (error_panel(described), histogram_panel(described))
    panels = [panel for panel in by_encoder if panel is not None]
    return {panel.name: panel for panel in (*panels, *yaw_panels(described), *recording_panels(described))}


def spans(panel: Panel) -> float:
    (part,) = panel.chart.parts
    return part.y.high - part.y.low


def full_session(rate_dps: np.ndarray = NOISE_DPS) -> Session:
    """Forty seconds at rest with every column, and with times that scatter."""
    scatter_s = np.random.default_rng(2).uniform(0.0, 1e-4, len(T_S))
    temp_c = np.linspace(20.0, 23.0, len(T_S))
    return Session("s", T_S + scatter_s, rate_dps, 1e9 + T_S, None, np.zeros(len(T_S)), temp_c)


def test_what_a_session_lacks_has_no_panel() -> None:
    """A rate and nothing else, too short for its noise; a session without a finite number has no panel at all."""
    bare = panels_of(Session("s", T_S[:1000], NOISE_DPS[:1000]))
    assert list(bare) == ["Yaw", "Bias", "Rate"]
    nan = np.full(10, np.nan)
    assert panels_of(Session("s", nan, nan, nan, None, nan, nan)) == {}


def test_times_that_never_change_have_no_panel() -> None:
    """Equal steps and equal delays, as a simulation has them, would be straight lines."""
    simulated = panels_of(Session("s", T_S, NOISE_DPS, 1e9 + T_S))
    assert not {"Time from sample to sample", "Delay of arrival"} & set(simulated)


def test_everything_recorded_has_a_panel() -> None:
    names = ["Yaw error", "Histogram of errors", "Yaw", "Bias", "Rate", "Temperature", "Drift against temperature"]
    assert list(panels_of(full_session())) == [
        *names,
        "Time from sample to sample",
        "Delay of arrival",
        "Noise at rest",
    ]


def test_drift_against_temperature_shows_its_slope() -> None:
    t_s = np.arange(12_000) / 100.0
    temp_c = 20.0 + t_s / 10.0
    motion_dps = np.where(t_s % 20.0 < 10.0, 0.0, 90.0)
    rate_dps = motion_dps + 0.05 * (temp_c - 20.0) + np.random.default_rng(1).normal(0.0, 0.02, len(t_s))
    angle_deg = np.cumsum(motion_dps) / 100.0
    for session in (
        Session("rests", t_s, rate_dps, None, None, angle_deg, temp_c),
        Session("turning", t_s, rate_dps - motion_dps + 30.0, None, None, 30.0 * t_s, temp_c),
    ):
        (_, slope) = panels_of(session)["Drift against temperature"].marks
        assert slope.name in {f"slope: 0.0{digits} deg/s per °C" for digits in ("49", "5", "51")}


def test_a_temperature_that_hardly_changes_shows_no_drift() -> None:
    temp_c = np.full(len(T_S), 20.0)
    assert "Drift against temperature" not in panels_of(Session("s", T_S, NOISE_DPS, None, None, None, temp_c))


def test_the_histogram_has_all_samples() -> None:
    (part,) = panels_of(full_session())["Histogram of errors"].chart.parts
    (bars,) = (series for series in part.series if series.shape is Shape.BOXES)
    assert bars.y_end is not None
    assert np.sum(bars.y_end) == pytest.approx(100.0)


@pytest.mark.parametrize(
    ("name", "least"),
    [
        ("Yaw", 2.0),
        ("Yaw error", 2.0),
        ("Bias", 0.1),
        ("Rate", 1.0),
        ("Temperature", 2.0),
        ("Time from sample to sample", 2.0),
        ("Delay of arrival", 5.0),
    ],
)
def test_no_scale_is_narrower_than_what_matters(name: str, least: float) -> None:
    """A still device that hardly drifts: degrees, deg/s, °C and ms."""
    assert spans(panels_of(full_session(1e-3 * NOISE_DPS))[name]) >= 0.999 * least


def test_wild_values_are_not_hidden_by_the_floor() -> None:
    """A spike of one sample is on the scale."""
    rate_dps = NOISE_DPS.copy()
    rate_dps[1234] = 300.0
    assert spans(panels_of(Session("s", T_S, rate_dps))["Rate"]) > 300.0
