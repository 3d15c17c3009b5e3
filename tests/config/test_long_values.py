"""A config of digits takes no longer than its length: a service that runs reads it between two samples."""

import time
from pathlib import Path

import pytest

from gyrodrift.config.model import load_config
from gyrodrift.values.errors import ConfigError

MOST_S = 2.0
"""Processor time for 100 000 digits; they took minutes where every digit was tried twice, and take 0.03 s."""


@pytest.mark.parametrize("value", ["{}L", "{}.{}L", ".{}L", "1e{}L", "-{}", "[{}L]"])
def test_a_long_number_is_refused_at_once(tmp_path: Path, value: str) -> None:
    """Whatever ends it."""
    path = tmp_path / "c.yaml"
    path.write_text(f"hdr: {{tau_s: {value.replace('{}', '1' * 50_000)}}}\n")
    begun_s = time.process_time()
    with pytest.raises(ConfigError):
        load_config(path)
    assert time.process_time() - begun_s < MOST_S
