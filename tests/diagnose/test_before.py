"""The check before a diagnosis: what recordings can show, and how two sets differ."""

from dataclasses import replace

import numpy as np
import pytest

from gyrodrift.diagnose.before import advice_for, smallest_sizes
from gyrodrift.diagnose.recording.lacking import lacking_values
from gyrodrift.diagnose.recording.recording import Recording
from gyrodrift.values.arrays import Floats

PERIOD_S = 0.01


def recording(noise_dps: float = 0.05, *, turns: bool = True, seconds: int = 120) -> Recording:
    """Turns of both directions at two speeds with rests between them, or only rest; stamps without scatter."""
    rng = np.random.default_rng(0)
    steps = np.tile(np.repeat([0.0, 30.0, 0.0, -90.0, 0.0, 90.0, 0.0, -30.0], 3 * 100), 1 + seconds // 24)
    rate_dps = turns * steps[: seconds * 100]
    device_s: Floats = np.arange(len(rate_dps), dtype=np.float64) * PERIOD_S
    temp_c: Floats = 25.0 + 0.01 * device_s
    return Recording(
        name="made",
        period_s=PERIOD_S,
        rate_dps=rate_dps + noise_dps * rng.standard_normal(len(rate_dps)),
        encoder_deg=np.concatenate([[0.0], np.cumsum(rate_dps[:-1]) * PERIOD_S]),
        device_s=device_s,
        host_s=device_s,
        temp_c=temp_c,
        powered_s=0.0,
        repeated=0,
        disordered=0,
        has_counter=False,
    )


def test_the_smallest_size_is_three_standard_errors() -> None:
    """The mean of 100 samples scatters by 0.005 deg/s; rates of 30 and 90 deg/s have a mean square of 2,250."""
    sizes = {size.effect: size for size in smallest_sizes([recording()])}
    assert sizes["scale_factor"].value == pytest.approx(100.0 * 3.0 * 0.005 / np.sqrt(120 * 2250.0), rel=0.3)
    assert sizes["scale_factor"].unit == "%"
    twice = {size.effect: size.value for size in smallest_sizes([recording(0.1)])}
    assert twice["scale_factor"] == pytest.approx(2.0 * sizes["scale_factor"].value, rel=0.1)


def test_without_motion_no_scale_shows() -> None:
    shown = {size.effect for size in smallest_sizes([recording(turns=False)])}
    assert not {"scale_factor", "scale_asymmetry", "latency"} & shown
    assert {"warmup", "temp_bias"} <= shown
    assert any(words.startswith("turns: ") for words in advice_for([recording(turns=False)]))


def test_advice_names_what_lacks() -> None:
    assert advice_for([recording()] * 3) == ["a change of temperature of 3 °C"]
    short = replace(recording(seconds=24), temp_c=None)
    assert advice_for([short])[0] == "a minute or more in all"


def test_even_stamps_count_samples() -> None:
    even = recording()
    jitter_s = 0.3 * PERIOD_S * np.random.default_rng(1).standard_normal(len(even.device_s))
    assert even.counts_samples
    assert not replace(even, device_s=even.device_s + jitter_s).counts_samples
    assert replace(even, device_s=even.device_s + jitter_s, has_counter=True).counts_samples


def test_a_missing_temperature_of_a_baseline_is_constant() -> None:
    lacking = lacking_values([recording()], [replace(recording(), temp_c=None, host_s=None)])
    assert lacking.has_constant_temperature
    assert lacking.of_one_set == {"host times"}
    assert lacking.remarks == [
        "baseline: it has no temperature, which counts as constant, as in a simulator",
        "baseline: only one of both sets has host times: this is no gap, and not compared; the baseline lacks it",
    ]
    back = lacking_values([replace(recording(), temp_c=None)], [recording()])
    assert back.of_one_set == {"temperature"}
