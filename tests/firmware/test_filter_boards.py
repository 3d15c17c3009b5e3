"""The filters on boards that are simulated: their yaw is that of this machine, and they fit."""

from pathlib import Path

import numpy as np
import pytest
from board_filter_support import AVR_RAM, M0_PLUS, M4F, BoardRun, board_samples, on_arm, on_avr, three_axis_samples
from c_attitude_support import samples as inertial
from c_filter_support import CFilters
from c_restlevel_support import samples

from gyrodrift.values.arrays import Floats

AVR_HZ = 16e6
SHARE = 0.25
"""Largest share of the time of an ATmega328P for HDR at 100 Hz."""

STATE_BYTES = 1060
"""Largest state of restlevel without the memory for portions."""

PORTION_S = 0.002
"""Longest call on an ATmega328P where the work is done in portions."""

CORES = {"M0+": M0_PLUS, "M4F": M4F}


def here(c_filters: CFilters, name: str, t_us: Floats, rate_dps: Floats) -> Floats:
    """Yaw of the filter in float on this machine."""
    inputs = rate_dps if name == "hdr" else samples(rate_dps)
    return c_filters.get(f"filter_{name}.c", "float").run(t_us, inputs, is_us=True).rows[:, 0]


@pytest.mark.parametrize("name", ["hdr", "restlevel"])
@pytest.mark.parametrize("core", CORES)
def test_a_cortex_m_gives_the_yaw_of_this_machine(tmp_path: Path, c_filters: CFilters, core: str, name: str) -> None:
    """A part with and one without floating point."""
    t_us, rate_dps = board_samples(200.0, 30.0)
    board = on_arm(tmp_path, CORES[core], name, t_us, rate_dps)
    assert np.abs(board.yaw_deg - here(c_filters, name, t_us, rate_dps)).max() < 0.01


@pytest.mark.parametrize("core", CORES)
def test_a_cortex_m_gives_the_attitude_of_this_machine(tmp_path: Path, c_filters: CFilters, core: str) -> None:
    """Three axes, and a stack of at most 4 KB."""
    t_us, inputs = three_axis_samples(100.0, 20.0)
    board = on_arm(tmp_path, CORES[core], "attitude", t_us, inputs)
    here = c_filters.get("filter_attitude.c", "float").run(t_us, inertial(inputs[:, :3], inputs[:, 3:]), is_us=True)
    assert np.abs(board.yaw_deg - here.rows[:, 0]).max() < 0.01
    assert board.stack_bytes <= 4096
    assert board.state_bytes <= 15_500


def test_hdr_fits_an_atmega328p(tmp_path: Path, c_filters: CFilters) -> None:
    t_us, rate_dps = board_samples(100.0, 60.0)
    board = on_avr(tmp_path, "hdr", t_us, rate_dps)
    assert np.abs(board.yaw_deg - here(c_filters, "hdr", t_us, rate_dps)).max() < 0.01
    assert board.costs.max() * 100.0 < SHARE * AVR_HZ
    assert board.state_bytes <= 80


def test_restlevel_fits_an_atmega328p(tmp_path: Path, c_filters: CFilters) -> None:
    """RAM left for a sketch, and a quarter of the time on average at 100 Hz."""
    t_us, rate_dps = board_samples(100.0, 120.0)
    board = on_avr(tmp_path, "restlevel", t_us, rate_dps)
    assert np.abs(board.yaw_deg - here(c_filters, "restlevel", t_us, rate_dps)).max() < 0.05
    assert left_bytes(board) >= 400
    assert board.costs.mean() * 100.0 < SHARE * AVR_HZ


def test_portions_of_restlevel_are_short_on_an_atmega328p(tmp_path: Path) -> None:
    """Four after each sample at 100 Hz do all the work between the samples."""
    t_us, rate_dps = board_samples(100.0, 60.0)
    board = on_avr(tmp_path, "restlevel", t_us, rate_dps, portions=4)
    assert board.costs.max() <= PORTION_S * AVR_HZ
    assert board.portions.max() <= PORTION_S * AVR_HZ
    assert left_bytes(board) >= 400


@pytest.mark.parametrize(("hypotheses", "auxiliary"), [(6, 0), (6, 1)])
def test_more_hypotheses_need_about_a_kilobyte_on_avr(tmp_path: Path, hypotheses: int, auxiliary: int) -> None:
    """Six as in Python, without and with rest sensor and temperature."""
    flags = (f"-DGD_RESTLEVEL_HYPOTHESES={hypotheses}", f"-DGD_RESTLEVEL_AUXILIARY={auxiliary}")
    board = on_avr(tmp_path, "restlevel", *board_samples(100.0, 5.0), *flags)
    assert board.state_bytes <= STATE_BYTES


def left_bytes(board: BoardRun) -> int:
    """RAM for a sketch beside the filter and its stack."""
    return AVR_RAM - board.state_bytes - board.stack_bytes
