"""Names of recordings."""

from datetime import UTC, datetime
from pathlib import Path

import pytest

from gyrodrift.recording.recorder import recording_path

BEGUN = datetime(2026, 5, 1, 12, 30, tzinfo=UTC)


@pytest.mark.parametrize(
    ("device", "profile", "name"),
    [
        ("bench-7", "turntable", "2026-05-01T12-30-00Z_bench-7_turntable.mcap"),
        ("", "", "2026-05-01T12-30-00Z.mcap"),
        ("", "slow turns/left", "2026-05-01T12-30-00Z_slow-turns-left.mcap"),
        ("x" * 5000, "y" * 5000, f"2026-05-01T12-30-00Z_{'x' * 80}_{'y' * 80}.mcap"),
        ("../..", "\0\n", "2026-05-01T12-30-00Z.mcap"),
        ("Gyro №5", "", "2026-05-01T12-30-00Z_Gyro-5.mcap"),
    ],
)
def test_a_name_says_what_is_known_in_words_that_any_disk_takes(
    tmp_path: Path, device: str, profile: str, name: str
) -> None:
    assert recording_path(tmp_path, BEGUN, device, profile) == tmp_path / name


def test_a_name_that_is_taken_gets_a_number(tmp_path: Path) -> None:
    for number in ("", "_2", "_3"):
        path = recording_path(tmp_path, BEGUN, "a", "")
        assert path.name == f"2026-05-01T12-30-00Z_a{number}.mcap"
        path.touch()


def test_a_link_to_nowhere_takes_a_name_too(tmp_path: Path) -> None:
    """A new file cannot be made under it."""
    path = recording_path(tmp_path, BEGUN, "a", "")
    path.symlink_to(tmp_path / "nowhere")
    assert recording_path(tmp_path, BEGUN, "a", "").name == "2026-05-01T12-30-00Z_a_2.mcap"
