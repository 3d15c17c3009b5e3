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


def rate_of(one: DesignMatrix) -> Floats:
    return regressors_of(one)[0].columns[:, 0]


def named(name: str, *tied_with: str) -> NamedCause:
    """As a verdict would name it."""
    effect = CATALOGUE[name].model_validate({"name": name, PARAMETERS[name]: 1.0})
    return NamedCause(Sized(candidate(name), 1.0), effect, "", "", 0.9, 0.9, (), tied_with)


def test_a_fit_is_ordinary_least_squares() -> None:
    """Coefficient, standard error and gain as numpy has them, over two sessions."""
    rng = np.random.default_rng(3)
    columns, values = rng.normal(size=(80, 1)), rng.normal(size=80)
    values += 0.7 * columns[:, 0]
    found = fit([Whitened(columns[:30], values[:30]), Whitened(columns[30:], values[30:])])
    (slope,), (left,), *_ = np.linalg.lstsq(columns, values)
    assert found.coefficient == pytest.approx(slope)
    assert found.error == pytest.approx(np.sqrt(left / 80.0 / (columns[:, 0] @ columns[:, 0])))
    assert found.log_likelihood_gain == pytest.approx(40.0 * np.log(values @ values / left))


def test_a_sine_and_a_cosine_have_one_amplitude() -> None:
    """3 and 4 make 5."""
    turn = np.linspace(0.0, 60.0, 500)
    columns = np.column_stack([np.sin(turn), np.cos(turn)])
    assert fit([Whitened(columns, columns @ [3.0, 4.0])]).coefficient == pytest.approx(5.0)


def test_columns_that_say_nothing_gain_nothing() -> None:
    """A device that never moved has no scale."""
    assert fit([Whitened(np.zeros((50, 1)), np.ones(50))]) == (0.0, 0.0, 0.0)


def test_innovations_of_a_random_walk_are_white() -> None:
    """With the steady gain of 1 they are its steps; with a gain of 0 a constant bias is taken away."""
    walk = np.cumsum(np.random.default_rng(4).normal(size=300))[:, None]
    assert innovations(1.0, walk)[1:] == pytest.approx(np.diff(walk, axis=0))
    assert innovations(0.0, walk).mean() == pytest.approx(0.0, abs=1e-12)


def test_a_bias_that_walks_is_seen_as_one() -> None:
    """A level that takes in 0.3 of each innovation is whitened into them; a constant one leaves the noise."""
    columns = [np.random.default_rng(5).normal(size=(BLOCKS, 1))]
    drawn = noise()
    level = 0.3 * np.concatenate([[0.0], np.cumsum(drawn)[:-1]])
    for values in (drawn + 3.0, level + drawn):
        (found,) = whitened(columns, values)
        white = found.values[5:]
        assert np.std(white) == pytest.approx(1.0, rel=0.1)
        assert abs(np.corrcoef(white[1:], white[:-1])[0, 1]) < 0.15


@pytest.mark.parametrize("bias_dps", [np.full(BLOCKS, 0.4), 0.4 + np.cumsum(noise(7)) / 3.0], ids=["constant", "walks"])
def test_a_planted_scale_is_found_with_its_size(bias_dps: Floats) -> None:
    """1.2 %, within what it says of itself, under a bias that is constant or walks."""
    designs = [design(1), design(2)]
    residuals_dps = [0.012 * rate_of(one) + bias_dps + noise(seed) for seed, one in enumerate(designs)]
    found = linear_model_of(residuals_dps, designs, [named("scale_factor")])
    assert (found.effect, found.parameter, found.unit) == ("scale_factor", "error_percent", "%")
    assert found.value == pytest.approx(1.2, rel=0.02)
    assert found.low < found.value < found.high
    assert found.agrees is True
    assert found.says == "agrees on scale_factor"


def test_every_linear_effect_is_told_from_the_others() -> None:
    """Planted at its own regressor."""
    one = design()
    for regressor in regressors_of(one):
        amount = NOISE_DPS * 30.0 / np.std(regressor.columns[:, 0])
        found = linear_model_of([amount * regressor.columns[:, 0] + noise()], [one], [])
        assert found.effect == regressor.effect


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
    """It agrees with a cause or what is tied with it, and does not judge effects that are not linear."""
    one = design()
    found = linear_model_of([0.012 * rate_of(one) + noise()], [one], causes)
    assert (found.agrees, found.says) == (agrees, says)


@pytest.mark.parametrize(
    ("causes", "agrees", "says"),
    [
        ([], True, "sees no linear effect"),
        ([named("latency")], None, "sees no linear effect"),
        ([named("temp_bias")], False, "sees no linear effect, where the verdict names one"),
    ],
)
def test_noise_has_no_linear_effect(causes: list[NamedCause], agrees: bool | None, says: str) -> None:  # noqa: FBT001 - parametrized
    """Which agrees with a verdict that names none."""
    found = linear_model_of([noise()], [design()], causes)
    assert found.effect is None
    assert (found.agrees, found.says) == (agrees, says)


def test_what_is_practically_negligible_is_not_named() -> None:
    """However clear it is: 3.5 thousandths of a degree per second once per turn, next to no noise."""
    one = design()
    (once,) = (regressor.columns[:, 0] for regressor in regressors_of(one) if regressor.effect == "g_sensitivity")
    found = [linear_model_of([amount * once + 0.01 * noise()], [one], []) for amount in (0.0035, 0.0045)]
    assert [one.effect for one in found] == [None, "g_sensitivity"]
    assert found[1].value == pytest.approx(0.0045, rel=0.01)
