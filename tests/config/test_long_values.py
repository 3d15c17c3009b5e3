"""A config of digits takes no longer than its length: a service that runs reads it between two samples."""

from pathlib import Path

import pytest

from gyrodrift.config.model import load_config
from gyrodrift.values.errors import ConfigError

DIGITS = 500_000
"""Digits that would take days if each were tried twice."""


@pytest.mark.promise("Configs and commands")
@pytest.mark.parametrize("value", ["{}L", "{}.{}L", ".{}L", "1e{}L", "-{}", "[{}L]"])
def test_a_long_number_is_refused_at_once(tmp_path: Path, value: str) -> None:
    """The time to read long numbers in a config grows with their length only."""
    path = tmp_path / "c.yaml"
    path.write_text(f"hdr: {{tau_s: {value.replace('{}', '1' * DIGITS)}}}\n")
    with pytest.raises(ConfigError):
        load_config(path)
