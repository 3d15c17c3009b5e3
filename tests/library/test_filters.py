"""The filters as objects: the bits of the service, by single samples, by arrays, and by parts of them."""

import math
from typing import Any

import numpy as np
import pytest

import gyrodrift
from gyrodrift.filters.hdr import HdrParams
from gyrodrift.filters.registry import FILTERS
from gyrodrift.library.filters import DriftFilter
from gyrodrift.values.errors import UsageError

PAIR: list[type[DriftFilter]] = [gyrodrift.Hdr, gyrodrift.Restlevel]


def samples(count: int = 3000) -> tuple[Any, Any]:
    """Rates and times with a bias, a rest, a turn, a time that goes back and a rate that is none."""
    draw = np.random.default_rng(3)
    t_s = 4.25 + np.cumsum(draw.uniform(0.008, 0.012, count))
    rate_dps = 0.4 + draw.normal(0.0, 0.1, count)
    rate_dps[count // 2 : count * 2 // 3] += 30.0
    t_s[700], rate_dps[800] = t_s[690], math.nan
    return rate_dps, t_s


@pytest.mark.parametrize("kind", PAIR)
def test_a_batch_has_the_bits_of_the_service(kind: type[DriftFilter]) -> None:
    rate_dps, t_s = samples()
    reference = FILTERS[kind.filter.name]
    state, c = reference.state(), reference.coefficients(reference.params())
    expected = []
    for t, rate in zip(t_s.tolist(), rate_dps.tolist(), strict=True):
        accepted = reference.step(c, state, t, rate)
        expected.append((state.yaw_deg, state.bias_dps, state.yaw_sigma_deg, accepted))

    whole, parts, single = kind().update_batch(rate_dps, t_s), kind(), kind()
    result = [parts.update_batch(rate_dps[a:b], t_s[a:b]) for a, b in ((0, 901), (901, 901), (901, 3000))]
    ones = [single.update_at(rate, t) for t, rate in zip(t_s, rate_dps, strict=True)]

    yaw_deg, bias_dps, sigma_deg, is_accepted = map(np.array, zip(*expected, strict=True))
    np.testing.assert_array_equal(whole.yaw_deg, yaw_deg)
    np.testing.assert_array_equal(whole.bias_dps, bias_dps)
    np.testing.assert_array_equal(whole.yaw_sigma_deg, sigma_deg)
    np.testing.assert_array_equal(whole.is_accepted, is_accepted)
    assert not whole.is_accepted[700]
    assert not whole.is_accepted[800]
    np.testing.assert_array_equal(np.concatenate([item.yaw_deg for item in result]), yaw_deg)
    np.testing.assert_array_equal([item.yaw_deg for item in ones], yaw_deg)


@pytest.mark.parametrize("kind", PAIR)
def test_steps_of_time_add_up_to_times(kind: type[DriftFilter]) -> None:
    rates = [0.5, 0.6, math.nan, 12.0, 0.5]
    steps, by_steps, by_times = [0.25, 0.25, 0.5, 0.25, -1.0], kind(), kind()
    result = [by_steps.update(rate, dt_s) for rate, dt_s in zip(rates, steps, strict=True)]
    expected = by_times.update_batch(rates, [0.25, 0.5, 1.0, 1.25, 0.25])
    assert [item.yaw_deg for item in result] == expected.yaw_deg.tolist()
    assert [item.is_accepted for item in result] == [True, True, False, True, False]
    by_steps.reset()
    assert by_steps.update(3.0, 0.01).yaw_deg == 0.0


def test_parameters_come_singly_or_as_a_record(tmp_path: Any) -> None:
    (tmp_path / "my.yaml").write_text("filter: restlevel\nhdr: {i_c_dps: 0.02}\n")
    assert gyrodrift.Hdr(HdrParams(i_c_dps=0.01), tau_s=0.5).params == HdrParams(i_c_dps=0.01, tau_s=0.5)
    assert gyrodrift.Hdr.from_config(tmp_path / "my.yaml").params == HdrParams(i_c_dps=0.02)


@pytest.mark.parametrize(
    ("given", "statement"),
    [
        (lambda: gyrodrift.Hdr(tau=1.0), "tau is not a parameter of hdr; did you mean tau_s?"),
        (lambda: gyrodrift.Hdr(tau_s=-1.0), "tau_s: Input should be greater than or equal to 0"),
        (lambda: gyrodrift.Restlevel(HdrParams()), "parameters are a RestlevelParams, not a HdrParams"),
        (lambda: gyrodrift.Hdr().update_batch([1.0, 2.0], [0.0]), "2 rates and 1 times"),
        (lambda: gyrodrift.Hdr().update_batch(["a"], [0.0]), "rate_dps is no series of numbers"),
        (lambda: gyrodrift.Hdr().update_batch([[1.0]], [0.0]), "the shape"),
    ],
)
def test_what_is_wrong_is_said(given: Any, statement: str) -> None:
    with pytest.raises(UsageError) as caught:
        given()
    assert statement in str(caught.value)
