"""Sessions of a bench as files, as a user of that simulator would write them."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from gyrodrift.effects import Effects, SimulatedGyro
from simulators.benches import BENCHES, RATE_HZ, Callback
from simulators.cases import SimulatorCase
from simulators.flaws import Floats, Signals

SESSIONS, SECONDS = 3, 60.0


def simulated(bench: str, seed: int, gyro: Callback | None = None, *, has_host: bool = False) -> Signals:
    """A session without flaws; the callback acts in the simulator."""
    rate_dps, angle_deg = BENCHES[bench](SECONDS, seed, gyro)
    t_s = np.arange(len(rate_dps)) / RATE_HZ
    late_s = 0.001 + 0.0002 * np.random.default_rng([seed, 5]).random(len(t_s))
    return Signals(t_s, t_s, t_s + late_s if has_host else None, rate_dps, rate_dps, angle_deg)


def noisy(signals: Signals, rng: np.random.Generator, dps_rthz: float) -> Floats:
    """Rate with white noise, deg/s."""
    noise: Floats = signals.rate_dps + dps_rthz * np.sqrt(RATE_HZ) * rng.standard_normal(len(signals.rate_dps))
    return noise


def columns_of(signals: Signals) -> dict[str, Floats]:
    """Columns with the names of a session."""
    columns = {"t_device_s": signals.stamp_s, "rate_dps": signals.rate_dps, "encoder_deg": signals.angle_deg}
    optional = {"t_host_s": signals.arrival_s, "temp_c": signals.temp_c}
    return columns | {name: values for name, values in optional.items() if values is not None}


def write_csv(path: Path, signals: Signals) -> None:
    """All digits: a simulator rounds nothing."""
    columns = columns_of(signals)
    rows = np.column_stack(list(columns.values()))
    np.savetxt(path, rows, "%.9g", ",", header=",".join(columns), comments="")


def write_set(folder: Path, case: SimulatorCase, seed: int, *, has_flaws: bool, count: int = SESSIONS) -> None:
    """Sessions of a case, with its flaws or as the simulator has them. Seeds give other motions and noise."""
    folder.mkdir(parents=True)
    for number in range(count):
        rng = np.random.default_rng([seed, number, 13])
        has_host = case.has_host if has_flaws else case.sim_has_host
        signals = simulated(case.bench, 1000 * seed + number, has_host=has_host)
        for flaw in case.dynamics if has_flaws else ():
            signals = flaw(signals, rng)
        noise = case.real_noise if has_flaws else case.sim_noise
        signals = replace(signals, rate_dps=noisy(signals, rng, noise))
        for flaw in case.readout if has_flaws else ():
            signals = flaw(signals, rng)
        write_csv(folder / f"{number}.csv", signals)


def write_again(folder: Path, case: SimulatorCase, seed: int, entries: Effects, count: int = SESSIONS) -> None:
    """Sessions of the simulator, whose gyro has the exported effects: its callback applies them sample by sample."""
    folder.mkdir(parents=True)
    for number in range(count):
        write_csv(folder / f"{number}.csv", _with_effects(case, seed, number, entries))


def _with_effects(case: SimulatorCase, seed: int, number: int, entries: Effects) -> Signals:
    rng = np.random.default_rng([seed, number, 13])
    gyro = SimulatedGyro(entries, 1.0 / RATE_HZ, int(rng.integers(1 << 31)))
    sigma_dps = case.sim_noise * np.sqrt(RATE_HZ)

    def read(rate_dps: float, t_s: float) -> float:
        return gyro.read(rate_dps + sigma_dps * rng.standard_normal(), t_s)

    return simulated(case.bench, 1000 * seed + number, read, has_host=case.sim_has_host)
