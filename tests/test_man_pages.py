"""Manual pages come from the parsers, and have every option and key."""

import importlib.util
import shutil
import subprocess
from pathlib import Path
from types import ModuleType

import pytest

from gyrodrift.cli import COMMANDS, parser_of
from gyrodrift.config.model import Config
from gyrodrift.filters.registry import CONFIG_KEYS, FILTERS
from gyrodrift.outputs.registry import OUTPUTS

PROGRAM = Path(__file__).parent.parent / ".ci" / "man_pages.py"


@pytest.fixture(scope="module")
def program() -> ModuleType:
    spec = importlib.util.spec_from_file_location("man_pages", PROGRAM)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def pages(program: ModuleType) -> dict[str, str]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("COLUMNS", "80")
        made: dict[str, str] = program.pages()
    return made


def test_there_is_a_page_for_each_command_and_the_config(pages: dict[str, str]) -> None:
    assert set(pages) == {"gyrodrift.1", "gyrodrift-config.5", *(f"gyrodrift-{name}.1" for name in COMMANDS)}


@pytest.mark.parametrize("name", COMMANDS)
def test_a_page_has_every_option_of_its_command(name: str, pages: dict[str, str], program: ModuleType) -> None:
    options = [option for action in parser_of(name)._actions for option in action.option_strings]
    assert [option for option in options if program.roff(option) not in pages[f"gyrodrift-{name}.1"]] == []


def test_the_page_of_the_config_has_every_key(pages: dict[str, str], program: ModuleType) -> None:
    page = pages["gyrodrift-config.5"]
    assert set(program.KEYS) == CONFIG_KEYS - {"text"}
    parameters = [name for kind in FILTERS.own.values() for name in kind.names]
    assert [name for name in (*parameters, *OUTPUTS.own) if program.roff(name) not in page] == []
    assert set(Config.__dataclass_fields__) - {"blocks", "completed", "text", "mode"} <= CONFIG_KEYS


def test_mandoc_finds_nothing(pages: dict[str, str], tmp_path: Path) -> None:
    if shutil.which("mandoc") is None:
        pytest.skip("no mandoc")
    for file, text in pages.items():
        (tmp_path / file).write_text(text)
    words = ["mandoc", "-T", "lint", "-W", "warning", *pages]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (0, "")
