"""Fixtures of the outputs."""

from collections.abc import Iterator

import pytest
from outputs_support import HubThread, hub


@pytest.fixture
def outputs() -> Iterator[HubThread]:
    """Outputs on a loop of their own, none of them wanted yet."""
    with hub() as running:
        yield running
