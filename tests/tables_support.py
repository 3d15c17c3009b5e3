"""A turn as other programs would have written it, and what the command makes of it."""

import csv
from collections.abc import Callable, Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np

from gyrodrift.cli import main

TURN_DEG, REST_S, TURN_S, END_S = 90.0, 12.0, 3.0, 30.0
BIAS_DPS = 0.4

Row = Callable[[int, float, float], str]
"""A line from the number of a sample, its time in s and its rate in deg/s."""


def samples(step_s: float = 0.05) -> Iterator[tuple[int, float, float]]:
    """Number, time and measured rate: rest, a quarter turn to the left, rest."""
    noise = np.random.default_rng(4)
    for number in range(round(END_S / step_s)):
        t_s = number * step_s
        is_turning = REST_S <= t_s < REST_S + TURN_S
        yield number, t_s, is_turning * TURN_DEG / TURN_S + BIAS_DPS + noise.normal(0.0, 0.05)


def table(row: Row, head: str = "", step_s: float = 0.05) -> str:
    """A table of that turn."""
    return head + "".join(row(*sample) + "\n" for sample in samples(step_s))


def written(path: Path, content: str | bytes) -> Path:
    """A file with that content."""
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


def filtered_yaw_deg(path: Path, *options: str) -> float:
    """The last yaw that `gyrodrift filter` writes."""
    out = path.with_name("filtered.csv")
    assert main(["filter", str(path), "--out", str(out), "--force", *options]) == 0
    with out.open() as file:
        return float(list(csv.DictReader(file))[-1]["yaw_deg"])


def angles_deg(step_s: float = 0.05) -> list[float]:
    turn, before = 170.0, [170.0]
    for (_, earlier_s, _), (_, t_s, _) in pairwise(samples(step_s)):
        turn += (REST_S <= earlier_s < REST_S + TURN_S) * TURN_DEG / TURN_S * (t_s - earlier_s)
        before.append((turn + 180.0) % 360.0 - 180.0)
    return before
