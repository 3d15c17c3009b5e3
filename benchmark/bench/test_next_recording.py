"""Next recordings: is what is predicted true, and how much better than at random; and how long it takes.

Pairs of causes that are hard to tell apart, each chosen for and then judged on sessions of random numbers of their own:
a session counts for the hypothesis that is likeliest under the same likelihood.
"""

import time
from collections.abc import Sequence

import numpy as np
import yaml
from blind.experiment import random_profile

from firmware_sim.motion.profile import Profile
from firmware_sim.rig import Base, Rig, parse_effect
from gyrodrift.diagnose.next_recording.choose import next_recording_of
from gyrodrift.diagnose.next_recording.information import feature_model, posteriors
from gyrodrift.diagnose.next_recording.simulated_features import (
    NOTHING,
    PlannedMotion,
    RigHypothesis,
    simulated_features,
)

FINE = Base(bias_dps=0.35)
COARSE = Base(bias_dps=0.35, noise_dps_rthz=0.006, encoder_cpr=4096)
MINUTES, FRESH, AT_RANDOM = 2.0, 8, 2

PAIRS = (
    (FINE, "bandwidth:cutoff_hz=40", "latency:delay_ms=4"),
    (COARSE, "bandwidth:cutoff_hz=30", "latency:delay_ms=5.3"),
    (FINE, "temp_bias:slope_dps_per_c=0.005", "warmup:amplitude_dps=-0.04,time_constant_s=240"),
    (FINE, "", "warmup:amplitude_dps=0.015"),
    (FINE, "vibration_rectification:bias_dps_at_100_dps=0.02", "scale_asymmetry:error_percent=0.03"),
    (COARSE, "g_sensitivity:amplitude_dps=0.01", "encoder_eccentricity:amplitude_deg=0.02"),
    (FINE, "popcorn:step_dps=0.03", "bias_instability:floor_dph=40"),
    (COARSE, "", "deadband:width_dps=0.03"),
    (FINE, "", "backlash:play_deg=0.01"),
    (COARSE, "", "backlash:play_deg=0.05"),
    (FINE, "scale_factor:error_percent=0.06", "nonlinearity:error_percent_fs=0.06"),
    (FINE, "", "temp_scale:slope_percent_per_c=0.006"),
    (COARSE, "latency:delay_ms=1", "backlash:play_deg=0.03"),
    (FINE, "", "saturation:limit_dps=200"),
    (FINE, "", "nonlinearity:error_percent_fs=0.02"),
    (FINE, "", "vibration_rectification:bias_dps_at_100_dps=0.01"),
    (FINE, "", "g_sensitivity:amplitude_dps=0.006"),
    (FINE, "", "temp_bias:slope_dps_per_c=0.002"),
    (FINE, "rate_random_walk:density_dps_rts=0.001", "bias_instability:floor_dph=20"),
    (COARSE, "", "bandwidth:cutoff_hz=60"),
    (COARSE, "", "encoder_eccentricity:amplitude_deg=0.02"),
)


def came_true(rigs: Sequence[Rig], base: Rig, profile: Profile, learning_rate: float) -> tuple[float, float]:
    """Mean posterior of the right hypothesis in new sessions of each, and the share in which it is the highest."""
    planned, even = PlannedMotion(profile, MINUTES), np.full(len(rigs), 1.0 / len(rigs))
    learned = simulated_features(rigs, base, planned, 7001, 5)
    model = feature_model(learned, learned.values.mean(axis=1))
    fresh = simulated_features(rigs, base, planned, 7002, FRESH).values
    found = [posteriors(model.log_likelihoods(values), even, learning_rate) for values in fresh]
    right = [each[:, number] for number, each in enumerate(found)]
    first = [each.argmax(axis=1) == number for number, each in enumerate(found)]
    return float(np.mean(right)), float(np.mean(first))


def drawn_profile(seed: int) -> Profile:
    """A motion at random, of MINUTES."""
    return Profile.model_validate(yaml.safe_load(random_profile(MINUTES, seed)))


def test_predictions_come_true_and_beat_chance() -> None:
    """Over all pairs the prediction is right within 0.05, and a motion at random tells clearly less."""
    rows = []
    for number, (stated, *texts) in enumerate(PAIRS):
        base = Rig(base=stated)
        rigs = [base.model_copy(update={"effects": (parse_effect(text),) if text else ()}) for text in texts]
        asked = [
            RigHypothesis(text.partition(":")[0] or NOTHING, rig, 0.5) for text, rig in zip(texts, rigs, strict=True)
        ]
        begun_s = time.process_time()
        found = next_recording_of(asked, MINUTES, seed=7 + number)
        took_s = time.process_time() - begun_s
        chosen = came_true(rigs, base, found.profile, found.predicted.learning_rate)
        drawn = np.mean(
            [came_true(rigs, base, drawn_profile(900 + number + seed), 1.0) for seed in range(AT_RANDOM)],
            axis=0,
        )
        rows.append((took_s, found.predicted.probability, *chosen, *drawn))
        names = ", ".join(one.name for one in found.maneuvers)
        print(f"{asked[0].name:24}{asked[1].name:26}{names:28}", *(f"{value:6.2f}" for value in rows[-1]))
    took_s, predicted, mean, right, random_mean, random_right = np.mean(rows, axis=0)
    print(f"{took_s:.1f} s CPU; predicted {predicted:.3f}, came true {mean:.3f}, right {right:.3f}")
    print(f"at random {random_mean:.3f}, right {random_right:.3f}")
    assert abs(predicted - mean) < 0.05
    assert mean > random_mean + 0.05
