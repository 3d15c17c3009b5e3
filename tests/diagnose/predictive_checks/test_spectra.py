"""Spectra of several sessions in one."""

import numpy as np
import pytest

from gyrodrift.diagnose.predictive_checks.residual_series import Spectra, pooled


def spectra(count: int, step_hz: float, level: float) -> Spectra:
    hz = (step_hz * np.arange(1, count + 1)).astype(np.float64)
    return Spectra(hz, np.full(count, level), np.full(count, 2.0 * level), np.full(count, 3.0 * level))


def test_levels_are_root_mean_squares_over_sessions() -> None:
    result = pooled([spectra(400, 0.001, 3.0), spectra(200, 0.002, 4.0)])
    assert result.hz[0] == 0.001
    assert result.hz[-1] == pytest.approx(0.4)
    assert result.real[-1] == pytest.approx(np.sqrt(12.5))
    assert result.real[0] == pytest.approx(3.0)
    assert np.allclose(result.after, 3.0 * result.real)


def test_sessions_without_are_passed_over() -> None:
    nothing = spectra(0, 1.0, 1.0)
    assert len(pooled([nothing, nothing]).hz) == len(pooled([]).hz) == 0
    assert pooled([nothing, spectra(50, 0.01, 2.0)]).real == pytest.approx(2.0)
