"""Clock and link, of times that are worked out."""

from dataclasses import replace

import numpy as np
import pytest
from features_support import PERIOD_S, T_S, TRUE_DPS, recorded, white

from gyrodrift.diagnose.features import timing
from gyrodrift.diagnose.recording.recording import Recording
from gyrodrift.values.arrays import Floats

COUNT = len(T_S)
CLEAN = recorded(TRUE_DPS)


def found_of(recording: Recording) -> dict[str, float]:
    values = timing.measure(recording).values
    assert np.isfinite(values).all()
    return {feature.name: float(value) for feature, value in zip(timing.FEATURES, values, strict=True)}


def stamped(device_s: Floats) -> dict[str, float]:
    return found_of(replace(CLEAN, device_s=device_s))


def arrived(host_s: Floats) -> dict[str, float]:
    return found_of(replace(CLEAN, host_s=host_s))


def test_a_perfect_clock_has_only_the_least() -> None:
    result = found_of(CLEAN)
    assert result["clock_ratio"] == pytest.approx(0.0, abs=1e-9)
    assert result["stamp_scatter"] == pytest.approx(np.log(3e-5), abs=0.02)
    assert result["stamp_step"] == pytest.approx(np.log(5e-4), abs=0.02)
    assert [result[f"arrival_gap_{percent}"] for percent in (5, 50, 95)] == pytest.approx([1.0] * 3, abs=1e-3)
    assert (result["drop_share"], result["drop_runs"], result["repeat_share"], result["disorder_share"]) == (0, 0, 0, 0)


@pytest.mark.parametrize("ppm", [-300.0, 50.0, 20_000.0])
def test_a_fast_clock_is_seen_in_ppm(ppm: float) -> None:
    """Against the host's; by itself a clock cannot be judged."""
    device_s = T_S * (1.0 + 1e-6 * ppm)
    assert stamped(device_s)["clock_ratio"] == pytest.approx(1e-6 * ppm, rel=1e-5)
    assert found_of(replace(CLEAN, device_s=device_s, host_s=None))["clock_ratio"] == 0.0


def test_stamps_scatter_by_what_they_do() -> None:
    result = stamped(T_S + white(5e-4))
    assert result["stamp_scatter"] == pytest.approx(np.log(5e-4 + 3e-5), abs=0.03)
    assert result["stamp_tails"] == 0.0


def test_single_stamps_that_are_far_off_are_tails() -> None:
    """Fifty of 20,000; each bends three neighbouring differences."""
    device_s = T_S + white(1e-4)
    device_s[200:20_000:396] += 0.02
    assert stamped(device_s)["stamp_tails"] == pytest.approx(np.sqrt(3.0 * 50.0 / COUNT), rel=0.02)


def test_a_clock_that_jumps_has_its_step() -> None:
    result = stamped(T_S + 0.03 * (T_S >= 100.0))
    assert result["stamp_step"] == pytest.approx(np.log(0.03 - 0.00225 + 5e-4), abs=0.01)


def test_a_clock_that_wanders_has_its_sigma() -> None:
    """A sine of 8 ms and 50 s; medians of ten seconds see sin(x) / x of it, x = π / 5."""
    result = stamped(T_S + 0.008 * np.sin(2.0 * np.pi * T_S / 50.0))
    seen_s = 0.008 / np.sqrt(2.0) * np.sin(np.pi / 5.0) / (np.pi / 5.0)
    assert result["stamp_wander"] == pytest.approx(np.log(seen_s + 5e-4), abs=0.08)


def test_arrivals_in_bunches_have_long_gaps_and_none() -> None:
    """Five at a time: four gaps in five are nothing, one is five periods."""
    result = arrived((np.arange(COUNT) // 5 * 5 + 4).astype(np.float64) * PERIOD_S)
    gaps = [result[f"arrival_gap_{percent}"] for percent in (5, 50, 75, 95)]
    assert gaps == pytest.approx([0.0, 0.0, 0.0, 5.0], abs=1e-6)
    # Off the line by 0 to 4 periods alike: a standard deviation of √2 of them.
    assert result["arrival_scatter"] == pytest.approx(np.log(np.sqrt(2.0) * PERIOD_S + 5e-4), abs=0.01)


def test_without_a_host_there_are_no_arrivals() -> None:
    result = found_of(replace(CLEAN, host_s=None))
    assert all(value == 0.0 for name, value in result.items() if name.startswith("arrival"))


def test_missing_samples_are_a_share_and_runs() -> None:
    """Five by themselves and a run of seven: two at a time."""
    lost = [50, 1000, 3000, 7000, 19_000, *range(9000, 9007)]
    device_s, host_s = T_S.copy(), T_S.copy()
    device_s[lost] = host_s[lost] = np.nan
    result = found_of(replace(CLEAN, device_s=device_s, host_s=host_s))
    assert result["drop_share"] == pytest.approx(np.sqrt(12.0 / COUNT))
    assert result["drop_runs"] == pytest.approx(np.log(2.0))
    assert result["stamp_scatter"] == pytest.approx(np.log(3e-5), abs=0.02)


def test_repeats_and_disorder_are_shares() -> None:
    result = found_of(replace(CLEAN, repeated=8, disordered=2))
    assert result["repeat_share"] == pytest.approx(np.sqrt(8.0 / COUNT))
    assert result["disorder_share"] == pytest.approx(np.sqrt(2.0 / COUNT))


@pytest.mark.parametrize("count", [2, 3, 50])
def test_a_few_samples_give_numbers(count: int) -> None:
    few = {name: getattr(CLEAN, name)[:count] for name in ("rate_dps", "encoder_deg", "device_s", "host_s")}
    assert set(found_of(replace(CLEAN, **few))) == {feature.name for feature in timing.FEATURES}
