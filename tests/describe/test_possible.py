"""Values that no sensor gives are told, and crash neither the text nor the picture."""

from pathlib import Path

import pytest

from gyrodrift.cli import main


@pytest.mark.parametrize(
    ("column", "value"), [("rate_dps", "1e308"), ("rate_dps", "-1e20"), ("temp_c", "1e308"), ("t_host_s", "1e305")]
)
def test_an_impossible_value_is_told_and_drawn_around(
    tmp_path: Path, column: str, value: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """The axes of a picture could show nothing else beside it."""
    path = tmp_path / "s.csv"
    names = ["t_device_s", "rate_dps", "temp_c", "t_host_s"]
    rows = [[f"{i * 0.01}", f"{i % 3}", "25", f"{i * 0.01}"] for i in range(600)]
    for row in rows[1::2]:
        row[names.index(column)] = value
    path.write_text("\n".join(map(",".join, [names, *rows])) + "\n")
    assert main(["info", str(path), "--picture", str(tmp_path / "p.png")]) == 0
    statement = capsys.readouterr().out
    assert f"! {column}" in statement
    assert "300 values outside of" in statement
    assert (tmp_path / "p.png").stat().st_size > 1000
