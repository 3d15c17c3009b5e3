"""Random numbers: a generator for each purpose, found from a path of names, so that one purpose never moves another."""

from hashlib import blake2b

import numpy as np

Path = tuple[str | int, ...]
Rng = np.random.Generator


def _key(path: Path) -> int:
    return int.from_bytes(blake2b("/".join(map(str, path)).encode(), digest_size=16).digest(), "little")


def effect_dice(path: Path) -> Rng:
    """For what an effect throws."""
    return np.random.Generator(np.random.Philox(key=_key(path)))


def noise_dice(path: Path) -> Rng:
    """For white noise."""
    return np.random.Generator(np.random.SFC64(_key(path)))


def plan_dice(path: Path) -> Rng:
    """For motions, devices and sizes."""
    return np.random.Generator(np.random.PCG64DXSM(_key(path)))


def sign(rng: Rng) -> float:
    """Plus or minus one."""
    return float(rng.choice([-1.0, 1.0]))
