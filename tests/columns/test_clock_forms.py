"""Clocks and rates in the forms of loggers: the same lines give the same turn as a file and at a port."""

from math import cos, radians, sin
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import ArrayLike
from sources_support import Host
from support import speaking_on
from tables_support import BIAS_DPS, END_S, TURN_DEG, samples, written

from gyrodrift.columns.spec import columns_of
from gyrodrift.session.files import load_session

STEP_S = 0.05
TURNED_DEG = TURN_DEG + BIAS_DPS * END_S
SECONDS = 86_400 - 12
"""The rows go over midnight, from 2024-05-01 to 2024-05-02."""


def of_day(t_s: float) -> tuple[int, int, int, int, int]:
    """Day of May 2024, hour, minute, second and millisecond."""
    total_ms = round(1e3 * (t_s + SECONDS))
    seconds, ms = divmod(total_ms, 1000)
    return 1 + seconds // 86_400, seconds // 3600 % 24, seconds // 60 % 60, seconds % 60, ms


def clock(t_s: float, mark: str = ".") -> str:
    _, hour, minute, second, ms = of_day(t_s)
    return f"{hour:02d}:{minute:02d}:{second:02d}{mark}{ms:03d}"


def twelve(t_s: float) -> str:
    _, hour, minute, second, ms = of_day(t_s)
    return f"{(hour + 11) % 12 + 1}:{minute:02d}:{second:02d}.{ms:03d} {'PM' if hour > 11 else 'AM'}"


def int32(value: int) -> int:
    return (value + 2**31) % 2**32 - 2**31


def quaternion(yaw_deg: float) -> str:
    half = radians(yaw_deg) / 2
    return f"{cos(half):.6f},0,0,{sin(half):.6f}"


ROWS = list(samples(STEP_S))
YAWS = np.cumsum([rate_dps * STEP_S for _, _, rate_dps in ROWS]).tolist()
FORMS: dict[str, tuple[str, list[str]]] = {
    "angle since the last sample": ("t_ms, delta", [f"{t * 1e3:.0f},{r * STEP_S:.5f}" for _, t, r in ROWS]),
    "the same in rad and a ticking clock": (
        "t:lsb/10000, delta:rad:-",
        [f"{t * 1e4:.0f},{-radians(r * STEP_S):.7f}" for _, t, r in ROWS],
    ),
    "time since the last sample": ("dt_ms, rate", [f"{STEP_S * 1e3 + n % 3 - 1},{r:.3f}" for n, _, r in ROWS]),
    "seconds and nanoseconds": (
        "t_s, +t_ns, rate",
        [f"{17e8 + t // 1:.0f},{t % 1 * 1e9:.0f},{r:.3f}" for _, t, r in ROWS],
    ),
    "date, time and milliseconds": (
        "t_s, +t_s, +t_ms, rate",
        [f"{of_day(t)[0]:02d}.05.2024,{clock(t)[:8]},{of_day(t)[4]},{r:.3f}" for _, t, r in ROWS],
    ),
    "time of day": ("t_s, rate", [f"{clock(t)};{r:.3f}" for _, t, r in ROWS]),
    "American date": ("t_s, rate", [f"5/{of_day(t)[0]}/2024 {twelve(t)},{r:.3f}" for _, t, r in ROWS]),
    "British date": ("t_s, rate", [f"{of_day(t)[0]}/5/2024 {clock(t)},{r:.3f}" for _, t, r in ROWS]),
    "name of the month": ("t_s, rate", [f"{of_day(t)[0]:02d}-May-2024 {clock(t)},{r:.3f}" for _, t, r in ROWS]),
    "minutes and seconds": ("t_s, rate", [f"{clock(t)[3:]},{r:.3f}" for _, t, r in ROWS]),
    "HHMMSS": ("t:hms, rate", [f"{clock(t).replace(':', '')},{r:.3f}" for _, t, r in ROWS]),
    "days": ("t:days, rate", [f"{45413.5 + t / 86400:.10f},{r:.3f}" for _, t, r in ROWS]),
    "ticks of 16 bits": ("t:lsb/1024, rate", [f"{round(t * 1024 + 6e4) % 65536},{r:.3f}" for _, t, r in ROWS]),
    "signed microseconds": ("t_us, rate", [f"{int32(round(t * 1e6) + 2**31 - 10**7)},{r:.3f}" for _, t, r in ROWS]),
    "fraction without zeros": ("t:s.us, rate", [f"{t // 1:.0f}.{t % 1 * 1e6:.0f},{r:.3f}" for _, t, r in ROWS]),
    "rows of two senders": (
        "=B, t_ms, rate",
        [line for n, t, r in ROWS for line in (f"A;{t * 1e3:.0f};0.1", f"B;{t * 1e3 + 7:.0f};{r:.3f}")],
    ),
    "objects of two senders": (
        'id=2, "t, ms"=t_ms, gz=rate',
        [
            line
            for n, t, r in ROWS
            for line in (f'{{"id":1,"t, ms":{n},"gz":0.1}}', f'{{"id":2.0,"t, ms":{t * 1e3:.0f},"gz":{r:.3f}}}')
        ],
    ),
    "objects of named senders": (
        "node=left, t=t_s, gz=rate",
        [
            line
            for _, t, r in ROWS
            for line in (f'{{"node":"left","t":{t:.3f},"gz":{r:.3f}}}', f'{{"node":"right","t":{t:.3f},"gz":9.5}}')
        ],
    ),
    "quaternion": (
        "t_ms, q.w, q.x, q.y, q.z",
        [f"{t * 1e3:.0f},{quaternion(yaw)}" for (_, t, _), yaw in zip(ROWS, YAWS, strict=True)],
    ),
}
"""SPEC and lines by what they show."""


def turned_deg(t_s: ArrayLike, rate_dps: ArrayLike) -> float:
    return float(np.sum(np.asarray(rate_dps)[1:] * np.diff(t_s)))


@pytest.mark.parametrize("form", FORMS)
def test_a_file_and_a_port_give_the_turn(form: str, tmp_path: Path, port: Path) -> None:
    spec, lines = FORMS[form]
    path = written(tmp_path / ("s.jsonl" if lines[0].startswith("{") else "s.csv"), "\n".join(lines) + "\n")
    session = load_session(path, columns_of(spec))
    assert turned_deg(session.t_device_s, session.rate_dps) == pytest.approx(TURNED_DEG, abs=0.6)
    assert np.ptp(session.t_device_s) == pytest.approx(END_S - STEP_S, abs=0.2)
    with speaking_on(port) as device, Host(port, baud=115200, columns=spec) as host:
        heard = host.hear(device, [f"{line}\n".encode() for line in lines], STEP_S * len(ROWS) / len(lines))
    assert turned_deg([s.t_device_s for s in heard], [s.rate_dps for s in heard]) == pytest.approx(TURNED_DEG, abs=0.6)
    assert host.link.counted()["damaged"] == host.link.counted()["gaps"] == host.link.counted()["device_resets"] == 0
