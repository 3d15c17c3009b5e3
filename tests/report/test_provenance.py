"""The last section of a page: when, by what and from what it was made."""

import re
from pathlib import Path

import pytest
from page_support import row, shown, words

from gyrodrift import __version__
from gyrodrift.report.page import page
from gyrodrift.report.provenance import Provenance, UsedFile, date_now, provenance, set_name


def test_it_tells_everything_that_is_known() -> None:
    """Date, version, sessions with their hashes, command and config."""
    files = (UsedFile("walk & talk", "ab" * 32, "training"), UsedFile("check", "cd" * 32, "test"))
    made = Provenance("sim", "gyrodrift tune <sim>", "2026-01-02 03:04:05 UTC", files, "found here", "hdr:\n  c1: 1")
    html = page("T", [shown("<h1>h</h1>"), provenance(made)])
    report = words(html)
    for part in ("2026-01-02 03:04:05 UTC", f"gyrodrift {__version__}", "sim (2 sessions)", "gyrodrift tune <sim>"):
        assert part in report
    assert "found here" in report
    assert "hdr: c1: 1" in report
    assert row(html, "walk & talk") == ["walk & talk", "training", "ab" * 32]


def test_what_is_not_known_is_not_told() -> None:
    html = page("T", [shown("<h1>h</h1>"), provenance(Provenance(sessions=(UsedFile("one"),)))])
    assert row(html, "one") == ["one"]
    for name in ("Date", "Config", "Command", "SHA-256", "used for"):
        assert name not in words(html)


@pytest.mark.parametrize(
    ("paths", "name"),
    [
        (["real"], "real"),
        (["real", "sim/a.mcap"], "real and a"),
        (["sim/a.mcap", "sim/b.mcap", "real"], "a, b and real"),
        (["sim/a.mcap", "sim/b.mcap", "sim/c.mcap", "sim/d.mcap"], "sim"),
        (["1", "2", "3", "4", "5"], "1, 2, 3 and 2 more"),
        (["."], "home"),
        ([], ""),
    ],
)
def test_a_set_has_the_name_of_its_folders(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, paths: list[str], name: str
) -> None:
    home = tmp_path / "home"
    for folder in ("real", "sim", *"12345"):
        (home / folder).mkdir(parents=True)
    monkeypatch.chdir(home)
    assert set_name([Path(path) for path in paths]) == name


def test_the_date_is_one() -> None:
    assert re.fullmatch(r"\d{4}-\d\d-\d\d \d\d:\d\d:\d\d UTC", date_now())
