"""The changelog has the form of Keep a Changelog, and its newest release is the version of the code."""

import re
from itertools import pairwise
from pathlib import Path

import gyrodrift

LINES = (Path(__file__).parent.parent / "docs" / "CHANGELOG.md").read_text().splitlines()
RELEASE = re.compile(r"## (\d+\.\d+\.\d+) — (\d{4}-\d{2}-\d{2})")
KINDS = {"Added", "Changed", "Deprecated", "Removed", "Fixed", "Security"}


def headings(marks: str) -> list[str]:
    return [line for line in LINES if line.startswith(f"{marks} ")]


def releases() -> list[tuple[str, str]]:
    matches = [RELEASE.fullmatch(heading) for heading in headings("##")[1:]]
    assert all(matches), "after Unreleased, a heading is ## VERSION — YYYY-MM-DD"
    return [(match[1], match[2]) for match in matches if match]


def test_changes_that_are_not_released_come_first() -> None:
    assert headings("##")[0] == "## Unreleased"


def test_the_newest_release_is_this_version() -> None:
    """`gyrodrift --version` and the changelog agree."""
    assert releases()[0][0] == gyrodrift.__version__


def test_releases_are_dated_and_in_order() -> None:
    dates = [date for _, date in releases()]
    assert dates
    assert all(later >= earlier for later, earlier in pairwise(dates))


def test_changes_are_sorted_by_their_kind() -> None:
    assert {heading.removeprefix("### ") for heading in headings("###")} <= KINDS
