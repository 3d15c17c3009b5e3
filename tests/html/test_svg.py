"""Figures for a page: in its colours, with names of their own, the same bytes each time, and lines that keep peaks."""

import re
from math import nan

import numpy as np
import pytest

pytest.importorskip("matplotlib", reason="pictures need the workstation extra")
import matplotlib as mpl

from gyrodrift.html.svg import (
    GRID,
    LINE_POINTS,
    QUIET,
    ROLES,
    TUNED,
    as_svg,
    canvas,
    label_factors,
    label_steps,
    styled,
    thinned,
)


def drawn(name: str = "waves") -> str:
    with styled():
        figure = canvas(3.0, 2.0, inset=0.1, bottom=0.2, top=0.9)
        axes = figure.add_subplot()
        axes.plot(np.linspace(-5.0, 5.0, 50), np.linspace(0.01, 1e6, 50), color=TUNED)
        axes.set_yscale("log")
        label_factors(axes.yaxis, 0.01, 1e6, 8)
        label_steps(axes.xaxis, 4)
        return as_svg(figure, name, "Waves")


def test_a_figure_is_an_element_that_says_what_it_is() -> None:
    """No head, comment, date, or style that would hold for all of the page."""
    svg = drawn()
    assert svg.startswith('<svg role="img" aria-label="Waves"')
    assert svg.endswith("</svg>")
    assert not re.search(r"<\?xml|<!|<style|<metadata>.*<dc:date>", svg, re.DOTALL)


def test_colours_are_roles_of_the_page() -> None:
    """None is left that light or dark would hide."""
    svg = drawn()
    assert set(re.findall(r"var\(--(\w+)\)", svg)) == {ROLES[colour] for colour in (GRID, QUIET, TUNED)}
    assert not re.search(r"#[0-9a-f]{6}\b(?!\")", svg)


def test_ids_are_those_that_are_referred_to() -> None:
    """And those of two figures differ."""
    one, two = ({*re.findall(r' id="([^"]+)"', drawn(name))} for name in ("one", "two"))
    assert one
    assert not one & two
    assert one == {*re.findall(r"#([\w-]+)[\")]", drawn("one"))}


def test_the_same_figure_gives_the_same_bytes() -> None:
    """However matplotlib is set to, which it is again afterwards."""
    first = drawn()
    with mpl.rc_context({"lines.color": "red", "font.size": 30.0, "axes.grid": False, "axes.facecolor": "black"}):
        assert drawn() == first
        assert mpl.rcParams["font.size"] == 30.0


def test_scales_are_labelled_as_a_person_writes() -> None:
    """A true minus, and no noughts to be counted."""
    words = re.findall(r">([^<>\n]+)</text>", drawn())
    assert words == ["−5", "0", "5", "0.01", "0.1", "1", "10", "100", "1000", "10⁴", "10⁵", "10⁶"]


def test_thinning_a_curve_keeps_its_peaks_and_ends() -> None:
    """Of a hundred thousand points one is high, and one low; a hole stays a hole."""
    x, y = np.arange(100_000.0), np.zeros(100_000)
    y[[12_345, 99_999]] = 7.0, -5.0
    y[50_000:60_000] = nan
    thin = thinned(x, y)
    assert len(thin.x) <= LINE_POINTS + 2
    assert (np.nanmax(thin.y), np.nanmin(thin.y)) == (7.0, -5.0)
    assert (thin.x[0], thin.x[-1]) == (0.0, 99_999.0)
    assert np.isnan(thin.y[(thin.x > 50_500) & (thin.x < 59_500)]).all()
    assert np.all(np.diff(thin.x) > 0.0)
