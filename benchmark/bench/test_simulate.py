"""How fast sessions are simulated, beside a loop over samples with the same five effects."""

import math
import random
import time
from pathlib import Path

from bench.harness import show
from firmware_sim.motion.profile import load_profile
from firmware_sim.rig import load_rig, parse_effect, with_effects
from gyrodrift.simulation.sessions import Simulation, write_sessions

EFFECTS = ("scale_factor", "bandwidth", "bias_instability", "rate_random_walk", "temp_bias")
LOOP_SAMPLES = 20_000


def simulation(rate_hz: float, minutes: float) -> Simulation:
    shipped = load_rig(None)
    base = shipped.base.model_copy(update={"sample_rate_hz": rate_hz})
    rig = with_effects(shipped.model_copy(update={"base": base}), [parse_effect(name) for name in EFFECTS])
    return Simulation(rig, load_profile("turntable"), 1, 0, minutes)


def written_s(rate_hz: float, folder: Path, ending: str) -> float:
    """Time to write an hour as a session."""
    wanted = simulation(rate_hz, 60.0)
    start_s = time.perf_counter()
    list(write_sessions(wanted.rig, wanted.profile, folder, seed=1, sessions=1, minutes=60.0, ending=ending))
    return time.perf_counter() - start_s


def looped_s_per_sample() -> float:
    """A straightforward loop: one sample after the other, in plain floats, nothing written."""
    dice, walk, lowpass, flicker = random.Random(1), 0.0, 0.0, [0.0] * 10
    decays = [math.exp(-0.01 / (0.3 * 3.0**power)) for power in range(10)]
    start_s, counts = time.perf_counter(), []
    for i in range(LOOP_SAMPLES):
        t_s = i * 0.01
        for _ in range(7):  # the analogue grid of a 10 Hz low-pass
            seen_dps = 60.0 * math.sin(2.0 * t_s) + dice.gauss(0.0, 0.1)
            lowpass += 0.09 * (seen_dps - lowpass)
        walk += dice.gauss(0.0, 0.0005)
        flicker = [decay * value + dice.gauss(0.0, 1e-5) for decay, value in zip(decays, flicker, strict=True)]
        temp_c = 25.0 + 8.0 * (1.0 - math.exp(-t_s / 240.0))
        rate_dps = 1.015 * lowpass + walk + sum(flicker) + 0.03 * (temp_c - 25.0)
        counts.append((i, round(t_s * 1e6), round(rate_dps / 0.00763), round(temp_c * 100.0)))
    return (time.perf_counter() - start_s) / LOOP_SAMPLES


def test_an_hour_is_written_faster_than_a_loop_could_compute_it(tmp_path: Path) -> None:
    """Five effects on, at 100 Hz and at 1 kHz; the loop is shown for an hour of 100 Hz."""
    at_100_hz_s, at_1_khz_s = (written_s(hz, tmp_path / f"{hz:g}", "mcap") for hz in (100.0, 1000.0))
    as_text_s = [written_s(hz, tmp_path / f"{hz:g}", "csv") for hz in (100.0, 1000.0)]
    looped_s = looped_s_per_sample() * 360_000
    show(
        "An hour with five effects, written as a session",
        [
            ("at 100 Hz", f"{at_100_hz_s:.2f} s"),
            ("at 1 kHz", f"{at_1_khz_s:.2f} s"),
            ("as csv, 100 Hz and 1 kHz", " ".join(f"{seconds:.2f} s" for seconds in as_text_s)),
            ("a loop over samples, 100 Hz, not written", f"{looped_s:.1f} s"),
            ("loop / simulate", f"{looped_s / at_100_hz_s:.1f}"),
        ],
    )
    assert (tmp_path / "100" / "session-01.csv").read_bytes().count(b"\n") == 360_001
