"""Programs that are compiled once for all tests of the firmware."""

from pathlib import Path

import pytest
from c_filter_support import CFilters
from firmware_support import built_board, built_sketch


@pytest.fixture(scope="module")
def sketch(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return built_sketch(tmp_path_factory.mktemp("sketch"))


@pytest.fixture(scope="module")
def board_program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return built_board(tmp_path_factory.mktemp("board"))


@pytest.fixture(scope="session")
def c_filters() -> CFilters:
    return CFilters()
