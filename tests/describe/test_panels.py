"""What is drawn of a session: nothing empty, and no scale so narrow that noise looks like drift."""

import numpy as np
import pytest

from gyrodrift.describe.describe import describe
from gyrodrift.describe.yaw import yaw_history_of
from gyrodrift.filters.registry import FILTERS
from gyrodrift.session.session import Session

pytest.importorskip("matplotlib", reason="pictures need the workstation extra")
from matplotlib.figure import Figure

from gyrodrift.describe.panels import Panel, Seen, recording_panels, yaw_panels

T_S = np.arange(4000) / 100.0
NOISE_DPS = np.random.default_rng(1).normal(0.0, 0.01, len(T_S))


def panels_of(session: Session) -> dict[str, Panel]:
    chosen = FILTERS["restlevel"]
    seen = Seen(session, describe(session), yaw_history_of(session, chosen, chosen.params()))
    return {one.name: one for one in (*yaw_panels(seen), *recording_panels(seen))}


def spans(panel: Panel) -> float:
    """Of its vertical scale, once it is drawn."""
    axes = Figure().add_subplot()
    panel.draw(axes)
    low, high = axes.get_ylim()
    return float(high - low)


def test_what_a_session_lacks_has_no_panel() -> None:
    """A rate and nothing else, too short for its noise; a session without one good number has none at all."""
    bare = panels_of(Session("s", T_S[:1000], NOISE_DPS[:1000]))
    assert list(bare) == ["Yaw", "Bias", "Rate", "Time from sample to sample"]
    nan = np.full(10, np.nan)
    assert panels_of(Session("s", nan, nan, nan, None, nan, nan)) == {}


def test_all_that_was_recorded_has_a_panel() -> None:
    """With an encoder the error too."""
    full = Session("s", T_S, NOISE_DPS, 1e9 + T_S, None, np.zeros(len(T_S)), np.full(len(T_S), 20.0))
    names = ["Yaw", "Yaw error", "Bias", "Rate", "Temperature", "Time from sample to sample", "Delay of arrival"]
    assert list(panels_of(full)) == [*names, "Noise at rest"]


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
    """Of a still device that hardly drifts: degrees, deg/s, °C and ms."""
    still = Session("s", T_S, 1e-3 * NOISE_DPS, 1e9 + T_S, None, np.zeros(len(T_S)), np.full(len(T_S), 20.0))
    assert spans(panels_of(still)[name]) >= 0.999 * least


def test_wild_values_are_not_hidden_by_the_floor() -> None:
    """A spike of one sample is on the scale."""
    rate_dps = NOISE_DPS.copy()
    rate_dps[1234] = 300.0
    assert spans(panels_of(Session("s", T_S, rate_dps))["Rate"]) > 300.0
