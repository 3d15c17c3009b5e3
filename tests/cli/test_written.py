"""Commands that write files say on stderr which, what they hold and how large they are; --quiet silences it."""

from pathlib import Path

import pytest

from gyrodrift.cli import main
from gyrodrift.cli.written import size_text


@pytest.fixture
def session(tmp_path: Path) -> Path:
    (tmp_path / "s.csv").write_text("t_device_s,rate_dps\n" + "".join(f"{i / 100},{i % 3}\n" for i in range(1234)))
    return tmp_path / "s.csv"


@pytest.mark.parametrize(
    ("words", "name", "contents"),
    [
        ("convert {session} {folder}/o.mcap", "o.mcap", "1,234 samples"),
        ("convert {session} {folder}/o.jsonl", "o.jsonl", "1,234 samples"),
        ("filter {session} --out {folder}/y.csv", "y.csv", "1,234 samples"),
        ("simulate --out {folder}/sim --minutes 0.05", "sim/session-01.mcap", "300 samples"),
    ],
)
def test_a_written_file_is_named(
    session: Path, words: str, name: str, contents: str, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = session.parent
    arguments = words.format(session=session, folder=folder).split()
    assert main(arguments) == 0
    size = size_text((folder / name).stat().st_size)
    assert capsys.readouterr().err == f"gyrodrift: {folder / name} written: {contents}, {size}\n"
    assert main([*arguments, "--force", "--quiet"]) == 0
    assert capsys.readouterr().err == ""


def test_sizes_have_three_digits() -> None:
    assert [size_text(size) for size in (12, 1234, 5_678_900, 2_500_000_000)] == [
        "12 bytes",
        "1.23 kB",
        "5.68 MB",
        "2.5 GB",
    ]
