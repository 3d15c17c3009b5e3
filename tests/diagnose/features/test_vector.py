"""The vector of all features, and what is derived from their records."""

import numpy as np
import pytest
from features_support import FACTS, T_S, TRUE_DPS, design_of, observed, observed_beside, recorded, white

from gyrodrift.diagnose.features.design_matrix import COLUMNS
from gyrodrift.diagnose.features.feature import RMS_DPS, Feature, ResponseLaw, numbers_of
from gyrodrift.diagnose.features.vector import FEATURES, IS_LOG, LINEAR, NUMBER, STATIC, measure, rms_scale
from gyrodrift.diagnose.recording.outliers import clean
from gyrodrift.values.arrays import Floats

STAGES = {"sensor", "environment", "platform", "encoder", "clock", "link"}
REGIMES = {"rest", "slow", "fast", "moving", "accelerating", "reversing", "warm", "early", "late", "always"}


@pytest.mark.parametrize("feature", FEATURES, ids=lambda feature: feature.name)
def test_a_record_says_all_of_its_feature(feature: Feature) -> None:
    """Stage and regime are known words; a threshold is positive, and what it amounts to is said."""
    assert feature.stage in STAGES
    assert feature.regime in REGIMES
    assert feature.threshold > 0.0
    assert feature.source
    assert feature.says


def test_names_are_unique() -> None:
    """Two features of one name are refused when they are collected."""
    with pytest.raises(ValueError, match="same name"):
        numbers_of((FEATURES[0], FEATURES[1], FEATURES[0]))


def test_masks_go_by_the_records() -> None:
    """A feature is linear, logarithmic or neither; coefficients come first, and only they and two more are linear."""
    assert not (LINEAR & IS_LOG).any()
    assert tuple(FEATURES[:STATIC]) == COLUMNS
    assert [FEATURES[number].name for number in np.flatnonzero(LINEAR)[STATIC:]] == [
        "lag",
        "lag_bend",
        "lag_twist",
        "warming",
        "clock_ratio",
    ]
    assert IS_LOG[NUMBER["wander_20s"]]


def test_values_and_thresholds_have_a_place_each() -> None:
    item = observed(TRUE_DPS + white(0.05))
    values, thresholds = measure(item.cleaned, item.design, FACTS)
    assert values.shape == thresholds.shape == (len(FEATURES),)
    assert np.isfinite(values).all()
    assert (thresholds >= 0.0).all()


def test_coefficients_are_read_as_rms() -> None:
    """A length over the root of how many there are: blocks, or samples."""
    scale = rms_scale(observed(TRUE_DPS).design)
    assert scale[NUMBER["rate"]] == pytest.approx(np.sqrt(200.0))
    assert scale[NUMBER["lag"]] == pytest.approx(np.sqrt(20_000.0))
    assert scale[NUMBER["warming"]] == scale[NUMBER["noise_rest_1"]] == 1.0


@pytest.mark.parametrize("rate_dps", [np.zeros(len(T_S)), np.full(len(T_S), 3.0)], ids=["zero", "constant"])
@pytest.mark.parametrize("angle_deg", [np.zeros(len(T_S)), 20.0 * T_S], ids=["still", "steady"])
def test_a_constant_recording_gives_numbers(rate_dps: Floats, angle_deg: Floats) -> None:
    assert np.isfinite(list(observed_beside(rate_dps, angle_deg).values().values())).all()


@pytest.mark.parametrize("seconds", [3, 12])
def test_a_short_recording_gives_numbers(seconds: int) -> None:
    count = 100 * seconds
    rate_dps = np.linspace(0.0, 30.0, count) + white(0.05, count=count)
    angle_deg = np.cumsum(np.linspace(0.0, 30.0, count)) * 0.01
    events = clean(recorded(rate_dps, angle_deg))
    assert np.isfinite(measure(events, design_of(events), FACTS).values).all()


def test_a_feature_saturates_where_nothing_is_said() -> None:
    feature = Feature("toy", "sensor", "rest", "a toy", 1.0, "one", reading=RMS_DPS)
    assert feature.response is ResponseLaw.SATURATING
