"""The linear model beside least squares worked out by hand, and what it says of a verdict."""

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from inference_support import PARAMETERS, candidate

from firmware_sim.effects.catalogue import CATALOGUE
from gyrodrift.diagnose.features.design_matrix import DesignMatrix
from gyrodrift.diagnose.inference.linear_model import (
    Whitened,
    fit,
    innovations,
    linear_model_of,
    regressors_of,
    whitened,
)
from gyrodrift.diagnose.inference.verdict import NamedCause
from gyrodrift.diagnose.simulate.response_table import Sized
from gyrodrift.values.arrays import Floats

BLOCKS, BLOCK = 600, 4
NOISE_DPS = 0.005


def design(seed: int = 1) -> DesignMatrix:
    """Steps of the rate of both signs; all that the linear model looks at."""
    rng = np.random.default_rng(seed)
    rate_dps = np.repeat(rng.choice([-90.0, -30.0, 0.0, 10.0, 60.0], BLOCKS // 10), 10 * BLOCK)
    period_s = 1.0 / BLOCK
    motion = SimpleNamespace(
        rate_dps=rate_dps,
        angle_deg=np.cumsum(rate_dps) * period_s,
        sensor_c=25.0 + 5.0 * np.sin(np.linspace(0.0, 7.0, len(rate_dps))),
        period_s=period_s,
        powered_s=0.0,
    )
    return cast("DesignMatrix", SimpleNamespace(motion=motion, block=BLOCK))


def noise(seed: int = 2) -> Floats:
    return np.random.default_rng(seed).normal(0.0, NOISE_DPS, BLOCKS)


def rate_of(entry: DesignMatrix) -> Floats:
    return regressors_of(entry)[0].columns[:, 0]


def named(name: str, *tied_with: str) -> NamedCause:
    effect = CATALOGUE[name].model_validate({"name": name, PARAMETERS[name]: 1.0})
    return NamedCause(Sized(candidate(name), 1.0), effect, "", "", 0.9, 0.9, (), tied_with)


def test_a_fit_is_ordinary_least_squares() -> None:
    """Coefficient, standard error and gain as numpy has them, over two sessions."""
    rng = np.random.default_rng(3)
    columns, values = rng.normal(size=(80, 1)), rng.normal(size=80)
    values += 0.7 * columns[:, 0]
    result = fit([Whitened(columns[:30], values[:30]), Whitened(columns[30:], values[30:])])
    (slope,), (remaining,), *_ = np.linalg.lstsq(columns, values)
    assert result.coefficient == pytest.approx(slope)
    assert result.error == pytest.approx(np.sqrt(remaining / 80.0 / (columns[:, 0] @ columns[:, 0])))
    assert result.log_likelihood_gain == pytest.approx(40.0 * np.log(values @ values / remaining))


def test_a_sine_and_a_cosine_have_one_amplitude() -> None:
    turn = np.linspace(0.0, 60.0, 500)
    columns = np.column_stack([np.sin(turn), np.cos(turn)])
    assert fit([Whitened(columns, columns @ [3.0, 4.0])]).coefficient == pytest.approx(5.0)


def test_columns_that_say_nothing_gain_nothing() -> None:
    """A device that never moved has no scale."""
    assert fit([Whitened(np.zeros((50, 1)), np.ones(50))]) == (0.0, 0.0, 0.0)


def test_innovations_of_a_random_walk_are_white() -> None:
    walk = np.cumsum(np.random.default_rng(4).normal(size=300))[:, None]
    assert innovations(1.0, walk)[1:] == pytest.approx(np.diff(walk, axis=0))
    assert innovations(0.0, walk).mean() == pytest.approx(0.0, abs=1e-12)


def test_a_bias_that_walks_is_seen_as_one() -> None:
    """A level that takes in 0.3 of each innovation is whitened into them; a constant one leaves the noise."""
    columns = [np.random.default_rng(5).normal(size=(BLOCKS, 1))]
    drawn = noise()
    level = 0.3 * np.concatenate([[0.0], np.cumsum(drawn)[:-1]])
    for values in (drawn + 3.0, level + drawn):
        (result,) = whitened(columns, values)
        white = result.values[5:]
        assert np.std(white) == pytest.approx(1.0, rel=0.1)
        assert abs(np.corrcoef(white[1:], white[:-1])[0, 1]) < 0.15


@pytest.mark.parametrize("bias_dps", [np.full(BLOCKS, 0.4), 0.4 + np.cumsum(noise(7)) / 3.0], ids=["constant", "walks"])
def test_a_planted_scale_is_found_with_its_size(bias_dps: Floats) -> None:
    designs = [design(1), design(2)]
    residuals_dps = [0.012 * rate_of(item) + bias_dps + noise(seed) for seed, item in enumerate(designs)]
    result = linear_model_of(residuals_dps, designs, [named("scale_factor")])
    assert (result.effect, result.parameter, result.unit) == ("scale_factor", "error_percent", "%")
    assert result.value == pytest.approx(1.2, rel=0.02)
    assert result.low < result.value < result.high
    assert result.agrees is True
    assert result.says == "agrees on scale_factor"


def test_every_linear_effect_is_told_from_the_others() -> None:
    item = design()
    for regressor in regressors_of(item):
        amount = NOISE_DPS * 30.0 / np.std(regressor.columns[:, 0])
        result = linear_model_of([amount * regressor.columns[:, 0] + noise()], [item], [])
        assert result.effect == regressor.effect


@pytest.mark.parametrize(
    ("causes", "agrees", "says"),
    [
        ([named("scale_factor")], True, "agrees on scale_factor"),
        ([named("latency", "scale_factor")], True, "agrees on scale_factor"),
        ([named("temp_bias")], False, "disagrees: it would name scale_factor"),
        ([], False, "disagrees: it would name scale_factor"),
        ([named("latency")], None, "sees scale_factor; cannot judge latency"),
    ],
)
def test_what_it_says_of_a_verdict(causes: list[NamedCause], agrees: bool | None, says: str) -> None:  # noqa: FBT001 - parametrized
    item = design()
    result = linear_model_of([0.012 * rate_of(item) + noise()], [item], causes)
    assert (result.agrees, result.says) == (agrees, says)


@pytest.mark.parametrize(
    ("causes", "agrees", "says"),
    [
        ([], True, "sees no linear effect"),
        ([named("latency")], None, "sees no linear effect"),
        ([named("temp_bias")], False, "sees no linear effect, where the verdict names one"),
    ],
)
def test_noise_has_no_linear_effect(causes: list[NamedCause], agrees: bool | None, says: str) -> None:  # noqa: FBT001 - parametrized
    result = linear_model_of([noise()], [design()], causes)
    assert result.effect is None
    assert (result.agrees, result.says) == (agrees, says)


def test_what_is_practically_negligible_is_not_named() -> None:
    item = design()
    (once,) = (regressor.columns[:, 0] for regressor in regressors_of(item) if regressor.effect == "g_sensitivity")
    result = [linear_model_of([amount * once + 0.01 * noise()], [item], []) for amount in (0.0035, 0.0045)]
    assert [item.effect for item in result] == [None, "g_sensitivity"]
    assert result[1].value == pytest.approx(0.0045, rel=0.01)
