"""Files read strictly: numbers are numbers, and every mistake is told with its place."""

import os
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pydantic import Field

from firmware_sim.rig import Rig
from firmware_sim.yaml_file import Checked, FileError, load


class Anything(Checked):
    """A block that takes every value, to see what a text is read as."""

    value: Any = None


class Drawer(Checked):
    depth_mm: float


class Desk(Checked):
    """Something with blocks and lists in it."""

    width_mm: float
    drawers: tuple[Drawer, ...] = Field(default=(), strict=False)


onto_one_file = settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
"""Each example overwrites the file of the one before."""


def read(folder: Path, text: str) -> Any:
    path = folder / "file.yaml"
    path.write_text(f"value: {text}\n", encoding="utf-8")
    return load(path, Anything).value


def mistakes(folder: Path, text: str | bytes, model: type[Checked] = Desk) -> list[str]:
    """The lines of complaint, without the folder."""
    path = folder / "file.yaml"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(FileError) as caught:
        load(path, model)
    return [line.removeprefix(f"{folder}/") for line in str(caught.value).splitlines()]


def complaints(path: Path) -> list[str]:
    try:
        load(path, Desk)
    except FileError as error:
        return str(error).split("\n")
    return []


@onto_one_file
@given(st.floats(allow_nan=False, allow_infinity=False))
def test_a_number_is_read_as_written(tmp_path: Path, number: float) -> None:
    """Every float comes back from the digits Python prints for it, exponents without a dot among them."""
    assert read(tmp_path, repr(number)) == number


@onto_one_file
@given(st.integers(-(10**30), 10**30))
def test_a_whole_number_stays_whole(tmp_path: Path, number: int) -> None:
    """Digits alone are an int of any size."""
    value = read(tmp_path, str(number))
    assert (type(value), value) == (int, number)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1e-3", 0.001),
        ("+2.5E+2", 250.0),
        (".5", 0.5),
        ("3.", 3.0),
        ("true", True),
        ("False", False),
        ("null", None),
        ("~", None),
        ("", None),
        ("on", "on"),
        ("yes", "yes"),
        ("010", "010"),
        ("0x10", "0x10"),
        ("1_000", "1_000"),
        ("1:30", "1:30"),
        ("2026-01-02", "2026-01-02"),
        ("TRUE", True),
        ("tRUE", "tRUE"),
        ("'1'", "1"),
        ('"true"', "true"),
        ("[1, [2, a]]", [1, [2, "a"]]),
        ("{a: 1}", {"a": 1}),
    ],
)
def test_a_text_means_one_thing(tmp_path: Path, text: str, value: object) -> None:
    result = read(tmp_path, text)
    assert (type(result), result) == (type(value), value)


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("width_mm: 1\nheight_mm: 2\n", "file.yaml:2:1 height_mm: is not known here"),
        ("drawers: []\n", "file.yaml:1:1 width_mm: is missing"),
        ("\n\nwidth_mm: 1\nwidth_mm: 2\n", "file.yaml:4:1 width_mm: is given twice"),
        (
            "width_mm: 1\ndrawers:\n  - depth_mm: 1\n    depth_mm: 1\n",
            "file.yaml:4:5 drawers.0.depth_mm: is given twice",
        ),
        ("width_mm: 1\ndrawers: [{depth_mm: 1}, {depth: 1, depth_mm: 1}]\n", "file.yaml:2:27 drawers.1.depth: is not"),
        ("width_mm: 1\ndrawers:\n  - {}\n", "file.yaml:3:5 drawers.0.depth_mm: is missing"),
        ("width_mm: wide\n", "file.yaml:1:1 width_mm: is 'wide'; input should be a valid number"),
        ("", "file.yaml:1:1 width_mm: is missing"),
        ("[1]", "file.yaml:1:1 the file: is [1]; "),
        ("width_mm: [1\n", "file.yaml:2:1 is not YAML: "),
        ("width_mm:\n\t- 1\n", "file.yaml:2:1 is not YAML: "),
        ("width_mm: *wide\n", "file.yaml:1:11 is not YAML: "),
        ("width_mm: 1\n---\nwidth_mm: 2\n", "file.yaml:2:1 is not YAML: "),
        (b"\xff\xfe\xfa", "file.yaml:1:1 is not text: byte 0xff is not UTF-8"),
    ],
)
def test_a_mistake_is_told_with_its_place(tmp_path: Path, text: str | bytes, line: str) -> None:
    """File, line, column and key come first, then what is wrong there."""
    (result,) = mistakes(tmp_path, text)
    assert result.startswith(line)


def test_all_mistakes_are_told_in_the_order_of_the_file(tmp_path: Path) -> None:
    """Mistakes of YAML's and of the model's stand together, sorted by their place."""
    lines = mistakes(tmp_path, "width_mm: on\ndepth: 1\ndrawers: [{depth_mm: 1, depth_mm: 2}, 3]\ndepth: 2\n")
    assert [line.split(" ")[0] for line in lines] == [
        f"file.yaml:{index}" for index in ("1:1", "2:1", "3:25", "3:39", "4:1")
    ]


@pytest.mark.parametrize("number", ["1e400", "-1e400", ".inf", "-.INF", ".nan"])
def test_a_number_has_to_be_finite(tmp_path: Path, number: str) -> None:
    """A number beyond all floats, infinity and what is no number are mistakes."""
    (line,) = mistakes(tmp_path, f"width_mm: {number}\n")
    assert line.endswith("finite number")


def test_a_file_that_cannot_be_read_is_named(tmp_path: Path) -> None:
    """A missing file and a folder are told by path and cause."""
    for path, cause in ((tmp_path / "none.yaml", "No such file"), (tmp_path, "Is a directory")):
        with pytest.raises(FileError, match=cause) as caught:
            load(path, Desk)
        assert str(caught.value).startswith(f"{path}: cannot be read: ")


def test_a_model_with_defaults_takes_an_empty_file(tmp_path: Path) -> None:
    (tmp_path / "file.yaml").write_text("# as shipped\n")
    assert load(tmp_path / "file.yaml", Anything) == Anything()


def test_what_was_read_cannot_be_changed(tmp_path: Path) -> None:
    """A checked value stays what the file says."""
    (tmp_path / "file.yaml").write_text("width_mm: 1\n")
    desk = load(tmp_path / "file.yaml", Desk)
    with pytest.raises(ValueError, match="frozen"):
        desk.width_mm = 2.0


@onto_one_file
@given(st.text(alphabet="ab:-[]{}&*#'\"|>!%@` \n,?~01.e+", max_size=40))
def test_any_text_is_read_or_told_about(tmp_path: Path, text: str) -> None:
    path = tmp_path / "file.yaml"
    path.write_text(text)
    assert all(line.startswith(f"{path}:") for line in complaints(path))


def test_a_block_that_contains_itself_is_a_mistake(tmp_path: Path) -> None:
    """YAML allows a list in itself; a rig does not."""
    assert any("is an alias" in line for line in mistakes(tmp_path, "width_mm: 1\ndrawers: &all [*all]\n"))


def test_a_control_character_is_told_in_one_line(tmp_path: Path) -> None:
    """A stray control character is one mistake and one line."""
    assert len(mistakes(tmp_path, "width_mm: \x01\n")) == 1


def test_a_key_that_is_no_text_is_told_in_words(tmp_path: Path) -> None:
    """A list as a key is a mistake of the file's, told without the inside of the parser."""
    assert "ScalarNode" not in "".join(mistakes(tmp_path, "width_mm: 1\n? [a]\n: 1\n"))


@pytest.mark.promise("Configs and commands")
@pytest.mark.parametrize(
    ("text", "statement"),
    [
        ("[" * 50_000, "is nested more than 32 times"),
        ("{a: " * 40 + "}" * 40, "is nested more than 32 times"),
        ("- " * 30_000, "is nested more than 32 times"),
        ("a" * 5_000_000, "is longer than"),
    ],
)
def test_a_file_that_was_made_to_hurt_is_refused(tmp_path: Path, text: str, statement: str) -> None:
    """A nested rig or profile without end is refused at once, in one line."""
    (report,) = mistakes(tmp_path, text)
    assert statement in report


def test_what_is_no_ordinary_file_is_not_opened(tmp_path: Path) -> None:
    """A pipe would wait for a writer."""
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(FileError, match="is not an ordinary file"):
        load(tmp_path / "pipe", Desk)


def test_what_is_said_of_a_file_is_short(tmp_path: Path) -> None:
    path = tmp_path / "rig.yaml"
    for text in ("".join(f"k{i}: 1\n" for i in range(9000)), "x" * 100_000, "x" * 200_000):
        path.write_text(text)
        with pytest.raises(FileError) as caught:
            load(path, Rig)
        assert len(str(caught.value)) < 20 * 700
