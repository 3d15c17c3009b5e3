"""The gallery: a picture of every effect."""

from pathlib import Path

import pytest
from support import Command

from firmware_sim.effects.catalogue import CATALOGUE
from firmware_sim.effects.triaxial.catalogue import TRIAXIAL

gallery = pytest.importorskip("pictures.effects", reason="the pictures need matplotlib, of the workstation extra")


def test_a_scene_is_that_of_an_effect() -> None:
    assert set(gallery.SCENES) <= set(CATALOGUE)


def test_a_picture_is_drawn_and_the_shipped_ones_are_complete(tmp_path: Path) -> None:
    with Command("pictures.effects", "--out", tmp_path, "vibration", module="benchmark") as run:
        assert run.end() == 0, run.log
    assert (tmp_path / "vibration.png").read_bytes().startswith(b"\x89PNG")
    shipped = {path.stem for path in (Path(__file__).parents[2] / "docs" / "effects").glob("*.png")}
    assert shipped == set(CATALOGUE)


def test_effects_on_all_axes_have_pictures_too(tmp_path: Path) -> None:
    with Command("pictures.effects", "--out", tmp_path, "accel_bias", module="benchmark") as run:
        assert run.end() == 0, run.log
    assert (tmp_path / "triaxial" / "accel_bias.png").read_bytes().startswith(b"\x89PNG")
    shipped = (Path(__file__).parents[2] / "docs" / "effects" / "triaxial").glob("*.png")
    assert {path.stem for path in shipped} == set(TRIAXIAL)
