"""How many frames a second one core takes, in process and through a pty, beside the obvious ways of doing it."""

import time
from collections.abc import Callable
from math import isfinite
from pathlib import Path
from statistics import median

import numpy as np

from bench.harness import (
    BENCH,
    PATIENCE_S,
    ROUND_SAMPLES,
    Chain,
    cpu_s,
    hello,
    in_chunks,
    logged,
    metronome,
    metronome_result,
    native_frames,
    nowhere,
    repeat,
    running,
    serving,
    show,
)
from gyrodrift.filters.hdr import (
    ATTENUATOR_TABLE,
    HdrCoefficients,
    HdrParams,
    HdrState,
    attenuated_step,
    coefficients,
    step,
)

Step = Callable[[HdrCoefficients, HdrState, float, float], bool]

ROUNDS = 5
FLOOD_SAMPLES = 4 * ROUND_SAMPLES
LOOP_SAMPLES = ROUND_SAMPLES // 4
"""For the readline loop, which takes about as long over a quarter of a round as `serve` over four."""


def test_frames_per_second_in_process() -> None:
    chunks = in_chunks(b"".join([hello(), *native_frames(ROUND_SAMPLES, 1000)]))
    seconds = repeat(ROUNDS, lambda: _push_all(chunks))
    show(
        "Decode, clock, filter and JSON line, in process",
        [
            ("frames per second", _per_second(ROUND_SAMPLES, median(seconds))),
            ("in the worst round", _per_second(ROUND_SAMPLES, seconds[-1])),
            ("one frame", f"{median(seconds) / ROUND_SAMPLES * 1e6:.2f} µs"),
        ],
    )


def test_frames_per_second_of_serve(tmp_path: Path) -> None:
    native = sorted(_flood(tmp_path / f"native{number}", "native") for number in range(ROUNDS))
    csv = sorted(_flood(tmp_path / f"csv{number}", "csv") for number in range(ROUNDS))
    loop_per_s = median(_flood_readline_loop(tmp_path / f"loop{number}") for number in range(ROUNDS))
    (native_per_s, native_per_cpu_s), (csv_per_s, _) = native[ROUNDS // 2], csv[ROUNDS // 2]
    show(
        "Through a pty, into /dev/null",
        [
            ("serve, native, frames per second", _per_second(native_per_s)),
            ("the same per second of processor, start-up included", _per_second(native_per_cpu_s)),
            ("serve, csv, lines per second", _per_second(csv_per_s)),
            ("pyserial readline loop, csv, lines per second", _per_second(loop_per_s)),
            ("serve / readline loop, native / csv", f"{native_per_s / loop_per_s:.1f}"),
            ("serve / readline loop, csv / csv", f"{csv_per_s / loop_per_s:.1f}"),
        ],
    )


def test_filter_step_in_plain_floats_and_in_numpy_scalars() -> None:
    rates = np.random.default_rng(1).normal(0.15, 0.1, 50_000)
    times = np.arange(rates.size) * 1e-3
    plain = [_step_all(step, times.tolist(), rates.tolist()) for _ in range(ROUNDS)]
    scalar = [_step_all(_numpy_step, list(times), list(rates)) for _ in range(ROUNDS)]
    assert isinstance(scalar[0][1].yaw_deg, np.float64)
    assert scalar[0][1] == plain[0][1]
    plain_s, scalar_s = median(seconds for seconds, _ in plain), median(seconds for seconds, _ in scalar)
    show(
        "Filter step",
        [
            ("plain floats", f"{plain_s / rates.size * 1e9:.0f} ns"),
            ("numpy scalars", f"{scalar_s / rates.size * 1e9:.0f} ns"),
            ("numpy scalars / plain floats", f"{scalar_s / plain_s:.1f}"),
        ],
    )


def _per_second(count: float, seconds: float = 1.0) -> str:
    return f"{count / seconds:,.0f}"


def _push_all(chunks: list[bytes]) -> float:
    with nowhere() as fd:
        chain = Chain(fd)
        started_s = time.perf_counter()
        for number, chunk in enumerate(chunks):
            chain.push(chunk, number * 0.2)
        seconds = time.perf_counter() - started_s
    assert chain.output.lines == ROUND_SAMPLES
    return seconds


def _flood(folder: Path, protocol: str) -> tuple[float, float]:
    """Samples per second, and per second of processor time, of a `serve` that is never left waiting."""
    folder.mkdir()
    port, log = folder / "gyro", folder / "serve.log"
    with (
        metronome(port, FLOOD_SAMPLES, protocol=protocol) as device,
        serving(port, "--filter", "hdr", log=log) as serve,
    ):
        device.wait(PATIENCE_S)
        busy_s = cpu_s(serve.pid)
        serve.terminate()
        serve.wait(PATIENCE_S)
    said = logged(log, "service_end")
    assert (said["samples"], said["lines"], said["missing"], said["damaged"]) == (FLOOD_SAMPLES, FLOOD_SAMPLES, 0, 0)
    return FLOOD_SAMPLES / metronome_result(port).seconds, FLOOD_SAMPLES / busy_s


def _flood_readline_loop(folder: Path) -> float:
    folder.mkdir()
    port = folder / "gyro"
    command = (BENCH / "readline_loop.py", port, str(LOOP_SAMPLES))
    with (
        metronome(port, LOOP_SAMPLES, protocol="csv") as device,
        running(*command, log=folder / "loop.log") as loop,
    ):
        assert loop.wait(PATIENCE_S) == 0, (folder / "loop.log").read_text()
        device.wait(PATIENCE_S)
    return LOOP_SAMPLES / metronome_result(port).seconds


def _step_all(advance: Step, times: list[float], rates: list[float]) -> tuple[float, HdrState]:
    table, state = coefficients(HdrParams()), HdrState()
    started_s = time.perf_counter()
    for t_s, rate_dps in zip(times, rates, strict=True):
        advance(table, state, t_s, rate_dps)
    return time.perf_counter() - started_s, state


def _numpy_step(c: HdrCoefficients, s: HdrState, t_s: float, rate_dps: float) -> bool:
    """`step` as it is for np.float64, whose truth values cannot be subtracted; only for finite samples."""
    if s.samples == 0:
        return step(c, s, t_s, rate_dps)
    dt_s = t_s - s.t_s
    if not (dt_s > 0.0 and isfinite(dt_s) and isfinite(rate_dps)):
        return False
    p = c.params
    omega_before = s.omega_dps
    sign = int(omega_before > 0.0) - int(omega_before < 0.0)
    s.run = s.run + 1 if s.samples >= 2 and sign == s.sign_before else 1
    if abs(omega_before) < p.theta_w_dps:
        s.i_dps -= sign * (c.steps_dps[s.run] if s.run < ATTENUATOR_TABLE else attenuated_step(p, s.run))
    s.lpf_dps = (rate_dps * dt_s + p.tau_s * s.lpf_dps) / (dt_s + p.tau_s)
    s.omega_dps = s.lpf_dps + s.i_dps
    s.omega_d_dps = s.omega_dps + p.tau_s / dt_s * (s.omega_dps - omega_before)
    s.yaw_deg += s.omega_d_dps * dt_s
    s.sign_before, s.t_s, s.samples = sign, t_s, s.samples + 1
    return True
