"""Sessions of a turntable made by a few lines of numpy, for tests that need to know every number of them."""

from pathlib import Path

import numpy as np

from gyrodrift.session.files import write_session
from gyrodrift.session.session import Session

RATE_HZ = 50.0


def turntable(seed: int, minutes: float = 2.0, bias_dps: float = 0.15, rate_hz: float = RATE_HZ) -> Session:
    """Ten seconds of rest and five of turning in turns, in both directions, with a bias and noise."""
    dice = np.random.default_rng(seed)
    count = round(minutes * 60.0 * rate_hz)
    t_s = np.arange(count) / rate_hz
    lap = (t_s // 15.0).astype(int)
    speeds_dps = dice.choice([-40.0, -12.0, 12.0, 40.0], lap.max() + 1)
    true_dps = np.where(t_s % 15.0 > 10.0, speeds_dps[lap], 0.0)
    rate_dps = true_dps + bias_dps + dice.normal(0.0, 0.05, count)
    encoder_deg = np.concatenate([[0.0], np.cumsum(true_dps[1:]) / rate_hz]) + 90.0
    return Session(f"table-{seed}", t_s, rate_dps, seq=np.arange(count), encoder_deg=encoder_deg)


def write_turntables(folder: Path, count: int, minutes: float = 2.0, ending: str = "csv") -> list[Path]:
    """`table-0` and so on."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = [folder / f"table-{seed}.{ending}" for seed in range(count)]
    for seed, path in enumerate(paths):
        write_session(path, [turntable(seed, minutes, 0.1 + 0.02 * seed)])
    return paths
