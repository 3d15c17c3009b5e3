"""The keys `axes:` and `mount:` of a config."""

from pathlib import Path

import pytest

from gyrodrift.config.model import load_config
from gyrodrift.values.errors import ConfigError
from gyrodrift.values.mount import Mount


def written(folder: Path, text: str) -> Path:
    path = folder / "axes.yaml"
    path.write_text(text)
    return path


@pytest.mark.parametrize(("text", "axes"), [("auto", "auto"), ("1", "1"), ("3", "3"), ("'3'", "3")])
def test_axes_are_a_number_or_auto(tmp_path: Path, text: str, axes: str) -> None:
    assert load_config(written(tmp_path, f"filter: restlevel\naxes: {text}\n")).axes == axes


def test_a_config_without_both_takes_what_the_device_sends_on_a_level_mount(tmp_path: Path) -> None:
    config = load_config(written(tmp_path, "filter: restlevel\n"))

    assert (config.axes, config.mount) == ("auto", Mount("+z", "+x"))


def test_a_mount_names_the_axes_that_point_up_and_forward(tmp_path: Path) -> None:
    config = load_config(written(tmp_path, "filter: restlevel\nmount: {up: -x, forward: +y}\n"))

    assert config.mount == Mount("-x", "+y")


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("axes: 2", "axes: is 2; expected auto, 1 or 3"),
        ("axes: true", "axes: is true (a truth value); expected auto, 1 or 3"),
        ("mount: up", "mount: is 'up' (text); expected a block such as {up: +z, forward: +x}"),
        ("mount: {up: z}", "mount.up: is 'z' (text); expected +x, -x, +y, -y, +z or -z"),
        ("mount: {upp: +z}", "mount.upp: "),
        ("mount: {up: +x}", "expected two different axes"),
        ("mount: {up: +z, forward: -z}", "expected two different axes"),
    ],
)
def test_a_wrong_value_is_told_with_what_is_expected(tmp_path: Path, line: str, expected: str) -> None:
    with pytest.raises(ConfigError) as caught:
        load_config(written(tmp_path, f"filter: restlevel\n{line}\n"))

    assert expected in str(caught.value)


def test_a_change_of_axes_and_mount_is_told(tmp_path: Path) -> None:
    old = load_config(written(tmp_path, "filter: restlevel\n"))
    new = load_config(written(tmp_path, "filter: restlevel\naxes: 1\nmount: {up: +z, forward: -y}\n"))

    assert new.changes_from(old) == ["axes: auto → 1", "mount.forward: +x → -y"]
