"""Templates: points between simulated sizes, their errors, random effects, and the prior of their points."""

from dataclasses import replace

import numpy as np
import pytest
from inference_support import (
    SESSIONS,
    SIZES,
    Simulated,
    candidate,
    observed,
    row,
    rows,
    scorer_of,
    simulated,
    simulated_at_random,
    template_of,
)

from gyrodrift.diagnose.features.vector import FEATURES, IS_LOG, LINEAR, NUMBER
from gyrodrift.diagnose.inference.evidence import Response
from gyrodrift.diagnose.inference.template import FINER, NOTICEABLE, Template, templates_of
from gyrodrift.diagnose.simulate.candidate import Touches
from gyrodrift.diagnose.simulate.response_table import ENOUGH
from gyrodrift.values.arrays import Floats

LOG = FEATURES[int(np.flatnonzero(IS_LOG & ~LINEAR)[0])].name
RATE = NUMBER["rate"]
COARSE, FINE = np.array([2.0, 8.0, 16.0]), np.linspace(2.0, 16.0, 29)


def curve(exponent: float) -> Simulated:
    """A candidate whose rate grows with a power of its size, simulated at three sizes of many."""
    nodes = COARSE[:, None, None, None] ** exponent * rows({"rate": 1.0})[:, None]
    return Simulated(replace(candidate("latency"), grid_points=COARSE, sizes=FINE), nodes)


def two_variants() -> Template:
    """Eight sizes each, of one effect."""
    first, second = (simulated("scale_factor", {"rate": per_size}) for per_size in (3.0, 4.0))
    return template_of(first, second._replace(candidate=replace(second.candidate, variant="second")))


def test_the_error_of_a_straight_line_is_exact_for_a_parabola() -> None:
    template = template_of(curve(2.0))
    true = np.square(template.size)
    assert template.interpolation_sigma[:, 0, RATE] == pytest.approx(template.mean[:, 0, RATE] - true, abs=1e-9)
    at_nodes = np.isin(template.size, COARSE)
    assert at_nodes.sum() == len(COARSE)
    assert not template.interpolation_sigma[at_nodes].any()
    assert (template.interpolation_sigma[~at_nodes, 0, RATE] > 0.0).all()


def test_a_change_in_proportion_to_the_size_has_no_error() -> None:
    template = template_of(curve(1.0))
    assert template.mean[:, 0, RATE] == pytest.approx(template.size)
    assert template.interpolation_sigma == pytest.approx(0.0, abs=1e-12)


def test_sizes_that_nobody_would_notice_are_no_points() -> None:
    """The change over all features and sessions is too short; an effect without any point has no template."""
    template = template_of(simulated("scale_factor", {"rate": 0.3}))
    lengths = np.linalg.norm(template.mean.reshape(len(template.size), -1), axis=1)
    assert template.size.tolist() == [size for size in SIZES if 0.3 * size * SESSIONS**0.5 > NOTICEABLE]
    assert (lengths > NOTICEABLE).all()
    assert scorer_of({}, simulated("scale_factor", {"rate": 0.1})).templates == {}


def test_points_of_all_variants_are_equally_probable() -> None:
    template = two_variants()
    assert template.log_prior == pytest.approx(np.full(16, -np.log(16.0)))
    assert template.response.tolist() == [0] * 8 + [1] * 8


def test_neighbors_are_of_one_variant() -> None:
    template = two_variants()
    assert template.near(3, 2) == [1, 2, 3, 4, 5]
    assert template.near(7, 2) == [5, 6, 7]
    assert template.near(8, 2) == [8, 9, 10]


def test_finer_points_are_on_straight_lines_and_as_probable_together() -> None:
    template = two_variants()
    finer = template.finer([9, 10, 11])
    assert len(finer.size) == 3 * FINER
    assert (finer.size[0], finer.size[-1]) == (1.5, 4.5)
    assert finer.mean[:, 1, RATE] == pytest.approx(4.0 * finer.size)
    assert np.logaddexp.reduce(finer.log_prior) == pytest.approx(np.log(3.0 / 16.0))
    assert set(finer.response.tolist()) == {1}
    assert template.finer([9]).size.tolist() == [2.0]


def test_the_nearest_point_is_found_on_a_finer_grid() -> None:
    """Points of the requested variant, within half of a finer step."""
    finer, point = two_variants().nearest_point(1, 5.3)
    assert finer.size[point] == pytest.approx(5.3, abs=0.05)
    assert finer.mean[point, 0, RATE] == pytest.approx(4.0 * finer.size[point])


def test_some_points_and_some_sessions_are_a_template() -> None:
    template = two_variants()
    part = template.subset([12, 2]).of_sessions([3])
    assert part.size.tolist() == [5.0, 3.0]
    assert part.mean.shape == (2, 1, len(FEATURES))
    assert part.mean[:, 0, RATE] == pytest.approx([20.0, 9.0])
    assert part.coarse.tolist() == [0, 1]


def test_coarse_points_are_of_all_variants() -> None:
    template = two_variants()
    assert template.size[template.coarse].tolist() == [1.0, 5.0, 1.0, 5.0]
    assert template.response[template.coarse].tolist() == [0, 0, 1, 1]


def test_a_phase_of_each_session_costs_its_occam_factor() -> None:
    per_size = rows({"turn_sine": 3.0}) * SIZES[:, None, None]
    free = Response(candidate("g_sensitivity"), per_size, phases_deg=np.zeros(SESSIONS))
    bound = replace(free, phases_deg=None)
    with_phases, without = (templates_of(observed({}), [response])[0].log_prior for response in (free, bound))
    expected = 0.5 * SESSIONS * np.log1p(2.0 * np.pi * np.square(3.0 * SIZES))
    assert without - with_phases == pytest.approx(expected)


def realized(count: int) -> Floats:
    """(sessions, realisations, F) at size 1: a rate of either sign, and a variance that is 1.5 times as large."""
    draws = np.random.default_rng(1).standard_normal((SESSIONS, count, 1))
    draws -= draws.mean(axis=1, keepdims=True)
    return draws * row({"rate": 2.0}) + row({LOG: np.log(1.5)})


def _variance(template: Template) -> Floats:
    variance: Floats = template.scatter + np.square(template.factors).sum(axis=2)
    return variance


def test_a_linear_feature_of_a_random_effect_has_no_mean() -> None:
    tried = simulated_at_random("bias_instability", realized(32))
    template = template_of(tried._replace(candidate=replace(tried.candidate, touches=Touches.SLOW_RATE)))
    variance = _variance(template)
    assert not template.mean[:, :, RATE].any()
    expected = np.square(realized(32)[:, :, RATE]).mean(axis=1)
    assert variance[:, :, RATE] == pytest.approx(np.square(template.size)[:, None] * expected)
    assert template.mean[:, :, NUMBER[LOG]] == pytest.approx(np.log(1.5) * template.size[:, None] * np.ones(SESSIONS))


def test_a_few_realisations_of_all_sessions_are_one_sample() -> None:
    """Enough of them are the session's own."""
    few, many = (
        template_of(simulated_at_random("bias_instability", realized(count))) for count in (ENOUGH - 1, ENOUGH)
    )
    variances = [_variance(template)[-1, :, RATE] for template in (few, many)]
    assert np.ptp(variances[0]) == pytest.approx(0.0, abs=1e-9)
    assert np.ptp(variances[1]) > 1.0
