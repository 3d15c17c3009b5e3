"""The filters of `gyrodrift.h` on boards: an ATmega328P in simavr, a Cortex-M0+ and a Cortex-M4F in QEMU."""

import re
import shutil
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from c_filter_support import write_header
from c_restlevel_support import drive, measured
from firmware_support import HERE, SIMAVR, compiled, run

from gyrodrift.values.arrays import Floats

M0_PLUS = ("-mcpu=cortex-m0plus", "-mthumb")
M4F = ("-mcpu=cortex-m4", "-mthumb", "-mfpu=fpv4-sp-d16", "-mfloat-abi=hard")
MACHINES = {M0_PLUS: "mps2-an385", M4F: "mps2-an386"}
"""Boards of QEMU; a Cortex-M3 runs the program of a Cortex-M0+ with the same instructions."""

TICKS = 1.6
"""Ticks of SysTick at 25 MHz in the 64 ns that QEMU counts for an instruction."""

AVR_RAM = 2048
ATMEGA328P, ATMEGA1284P = "atmega328p", "atmega1284p"
RAM = {ATMEGA328P: AVR_RAM, ATMEGA1284P: 16384}
"""Bytes of RAM. The larger chip holds the filter of three axes."""

FILTERS = {"hdr": (), "restlevel": ("-DFILTER_RESTLEVEL",), "attitude": ("-DFILTER_ATTITUDE",)}


class BoardRun(NamedTuple):
    """Cycles (AVR) or instructions (ARM) of each update, the outputs after it, and sizes in bytes.

    portions
        Costs of the portions of work after each update, shape (samples, portions).
    """

    costs: Floats
    portions: Floats
    yaw_deg: Floats
    bias_dps: Floats
    stack_bytes: int
    program_bytes: int
    state_bytes: int


def board_samples(rate_hz: float, seconds: float, seed: int = 45) -> tuple[Floats, Floats]:
    """Times in µs and rates in deg/s of rests and turns; times jitter as those of a board do."""
    rng = np.random.default_rng(seed)
    t_s = np.arange(round(rate_hz * seconds)) / rate_hz
    late_s = rng.uniform(0.0, 2e-4, len(t_s))
    return np.rint((t_s + late_s) * 1e6), measured(rng, drive(rng, t_s)[0]).astype(np.float32).astype(np.float64)


def on_avr(
    folder: Path, name: str, t_us: Floats, inputs: Floats, *flags: str, portions: int = 0, chip: str = ATMEGA328P
) -> BoardRun:
    """Run a filter on an AVR in simavr, with so many portions of work after each update."""
    if shutil.which("avr-gcc") is None or not SIMAVR.is_dir():
        pytest.skip("there is no avr-gcc or no simavr: apt-get install gcc-avr avr-libc libsimavr-dev")
    elf, samples = folder / "board.elf", write_samples(folder, t_us, inputs)
    program("avr-gcc", elf, "-Os", f"-mmcu={chip}", f"-DPORTIONS={portions}", *FILTERS[name], *flags)
    heap = re.search(r"(\w+) . _end\n", run("avr-nm", elf))
    assert heap is not None
    *lines, free = run(compiled("avr_cycles.c", folder, "-lsimavr", "-lm"), elf, samples, heap[1], chip).splitlines()
    rows = np.loadtxt(lines, delimiter=",").reshape(-1, 1 + portions, 3)
    costs, yaw_deg, bias_dps = rows[:, 0].T
    program_bytes, static_bytes = sizes("avr-size", elf)
    stack_bytes = RAM[chip] - static_bytes - int(free)
    state = state_bytes("avr-nm", elf)
    return BoardRun(costs, rows[:, 1:, 0], yaw_deg, bias_dps, stack_bytes, program_bytes, state)


def three_axis_samples(rate_hz: float, seconds: float, seed: int = 45) -> tuple[Floats, Floats]:
    """Times in µs, and rates and accelerations (n, 6) of a device that leans, turns about the vertical, and rests."""
    t_us, rate_dps = board_samples(rate_hz, seconds, seed)
    up = np.array((0.6, 0.0, 0.8))
    noise = np.random.default_rng(seed).normal(size=(len(t_us), 6)) * (0.05, 0.05, 0.05, 0.03, 0.03, 0.03)
    rows = noise + np.concatenate((rate_dps[:, None] * up, np.tile(9.81 * up, (len(t_us), 1))), axis=1)
    return t_us, rows.astype(np.float32).astype(np.float64)


def on_arm(folder: Path, core: tuple[str, ...], name: str, t_us: Floats, inputs: Floats, *flags: str) -> BoardRun:
    """Run a filter on a Cortex-M in QEMU; inputs are rates (n), or rates and accelerations (n, 6)."""
    if shutil.which("arm-none-eabi-gcc") is None or shutil.which("qemu-system-arm") is None:
        pytest.skip("there is no ARM compiler or no QEMU: apt-get install gcc-arm-none-eabi qemu-system-arm")
    elf = folder / "board.elf"
    write_samples(folder, t_us, inputs)
    linked = ("-nostartfiles", "--specs=nosys.specs", "-w", f"-T{HERE / 'board_arm.ld'}", "-Wl,--gc-sections")
    program("arm-none-eabi-gcc", elf, "-O2", "-ffunction-sections", *core, *FILTERS[name], *flags, *linked)
    semihosting = ("-semihosting-config", "enable=on,target=native")
    machine = ("-M", MACHINES[core], "-display", "none", "-monitor", "none", "-serial", "none")
    run("qemu-system-arm", *machine, *semihosting, "-icount", "shift=6", "-kernel", elf, folder=folder)
    result = (folder / "result.bin").read_bytes()
    rows = np.frombuffer(result[:-4], dtype=[("ticks", "<u4"), ("yaw_deg", "<f4"), ("bias_dps", "<f4")])
    return BoardRun(
        rows["ticks"] / TICKS,
        np.zeros((len(rows), 0)),
        rows["yaw_deg"].astype(np.float64),
        rows["bias_dps"].astype(np.float64),
        int.from_bytes(result[-4:], "little"),
        sizes("arm-none-eabi-size", elf)[0],
        state_bytes("arm-none-eabi-nm", elf),
    )


def write_samples(folder: Path, t_us: Floats, inputs: Floats) -> Path:
    """File of samples for a board: u32 t_us, then a float for each input."""
    rows = np.zeros(len(t_us), dtype=[("t_us", "<u4"), ("inputs", "<f4", inputs.shape[1:])])
    rows["t_us"], rows["inputs"] = t_us % 2**32, inputs
    path = folder / "samples.bin"
    rows.tofile(path)
    return path


def program(compiler: str, elf: Path, *flags: str) -> None:
    """Compile `board_filter.c`."""
    write_header(elf.parent)
    run(compiler, "-std=c11", *flags, f"-I{elf.parent}", HERE / "board_filter.c", "-o", elf, "-lm")


def sizes(tool: str, elf: Path) -> tuple[int, int]:
    """Bytes of flash, and of RAM without stack."""
    text, data, bss = run(tool, elf).splitlines()[1].split()[:3]
    return int(text) + int(data), int(data) + int(bss)


def state_bytes(tool: str, elf: Path) -> int:
    """Size of the filter's struct."""
    match = re.search(r"\w+ (\w+) b filter\n", run(tool, "-S", elf))
    assert match is not None
    return int(match[1], 16)
