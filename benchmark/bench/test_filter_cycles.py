"""Cycles, instructions and memory of the filters on an ATmega328P, a Cortex-M0+ and a Cortex-M4F."""

from pathlib import Path

import pytest
from board_filter_support import (
    ATMEGA1284P,
    AVR_RAM,
    M0_PLUS,
    M4F,
    BoardRun,
    board_samples,
    on_arm,
    on_avr,
    three_axis_samples,
)

from bench.harness import show

pytestmark = pytest.mark.timeout(1800)

SECONDS = 300.0
SIX = ("-DGD_RESTLEVEL_HYPOTHESES=6", "-DGD_RESTLEVEL_AUXILIARY=1")
"""Restlevel as in Python, on AVR."""


def rows_of(board: BoardRun, unit: str, hz: float, rate_hz: float) -> list[tuple[str, str]]:
    """Costs and sizes as lines of a table."""
    mean, worst = board.costs.mean(), board.costs.max()
    share = f" ({100.0 * mean * rate_hz / hz:.1f} % of {hz / 1e6:.0f} MHz at {rate_hz:.0f} Hz)"
    longest = f" ({1e3 * worst / hz:.1f} ms)"
    return [
        (f"{unit} of an update, mean", f"{mean:.0f}{share}"),
        (f"{unit} of an update, longest", f"{worst:.0f}{longest}"),
        ("state", f"{board.state_bytes} bytes"),
        ("stack", f"{board.stack_bytes} bytes"),
        ("flash, filter and mathematics", f"{board.program_bytes} bytes"),
    ]


@pytest.mark.parametrize(("name", "flags"), [("hdr", ()), ("restlevel", ()), ("restlevel", SIX)])
def test_an_atmega328p_has_time_and_memory(tmp_path: Path, name: str, flags: tuple[str, ...]) -> None:
    """Rests and turns at 100 Hz in simavr, whose cycles are those of the data sheet."""
    board = on_avr(tmp_path, name, *board_samples(100.0, SECONDS), *flags)
    rows = rows_of(board, "cycles", 16e6, 100.0)
    free = ("RAM left", f"{AVR_RAM - board.state_bytes - board.stack_bytes} bytes")
    show(f"{name} {' '.join(flags)} on an ATmega328P", [*rows, free])
    assert board.costs.mean() < 40_000


def test_portions_of_restlevel_take_2_ms_of_an_atmega328p(tmp_path: Path) -> None:
    """Four after each sample at 100 Hz."""
    board = on_avr(tmp_path, "restlevel", *board_samples(100.0, SECONDS), portions=4)
    show("restlevel in portions on an ATmega328P", rows_of_portions(board, 16e6))
    assert max(board.costs.max(), board.portions.max()) <= 32_000


def test_portions_of_the_attitude_filter_on_a_chip_without_floating_point(tmp_path: Path) -> None:
    """An ATmega1284P stands for a Cortex-M0+: it computes floats by software, too. It has RAM for five hypotheses.

    `-fno-ivopts`: without it avr-gcc 5.4 takes a wrong address.
    """
    flags = ("-DGD_ATTITUDE_HYPOTHESES=5", "-fno-ivopts")
    samples = three_axis_samples(100.0, 30.0)
    board = on_avr(tmp_path, "attitude", *samples, *flags, portions=3, chip=ATMEGA1284P)
    show("attitude in portions on an ATmega1284P, at the clock of a Cortex-M0+", rows_of_portions(board, 48e6))
    assert max(board.costs.max(), board.portions.max()) <= 480_000


def rows_of_portions(board: BoardRun, hz: float) -> list[tuple[str, str]]:
    """Longest update and longest portion, and the mean of both for a sample."""
    total = board.costs + board.portions.sum(axis=1)
    return [
        ("cycles of an update, longest", f"{board.costs.max():.0f} ({1e3 * board.costs.max() / hz:.1f} ms)"),
        ("cycles of a portion, longest", f"{board.portions.max():.0f} ({1e3 * board.portions.max() / hz:.1f} ms)"),
        ("cycles for a sample with its portions, mean", f"{total.mean():.0f}"),
        ("state and stack", f"{board.state_bytes} and {board.stack_bytes} bytes"),
    ]


@pytest.mark.parametrize("name", ["hdr", "restlevel"])
@pytest.mark.parametrize(("core", "title", "hz"), [(M0_PLUS, "Cortex-M0+", 48e6), (M4F, "Cortex-M4F", 64e6)])
def test_a_cortex_m_has_time_and_memory(
    tmp_path: Path, core: tuple[str, ...], title: str, hz: float, name: str
) -> None:
    """Rests and turns at 200 Hz in QEMU, which counts instructions."""
    board = on_arm(tmp_path, core, name, *board_samples(200.0, SECONDS))
    show(f"{name} on a {title}", rows_of(board, "instructions", hz, 200.0))
    assert board.costs.mean() < 24_000 / 2.0  # an instruction takes one cycle, or two


@pytest.mark.parametrize("hypotheses", [6, 3])
@pytest.mark.parametrize(("core", "title", "hz"), [(M0_PLUS, "Cortex-M0+", 48e6), (M4F, "Cortex-M4F", 64e6)])
def test_a_cortex_m_has_time_for_three_axes(
    tmp_path: Path, core: tuple[str, ...], title: str, hz: float, hypotheses: int
) -> None:
    """Rests and turns of a leaning device at 200 Hz in QEMU."""
    flag = f"-DGD_ATTITUDE_HYPOTHESES={hypotheses}"
    board = on_arm(tmp_path, core, "attitude", *three_axis_samples(200.0, SECONDS), flag)
    show(f"attitude, {hypotheses} hypotheses, on a {title}", rows_of(board, "instructions", hz, 200.0))
    assert board.costs.mean() * 200.0 < 0.9 * hz
