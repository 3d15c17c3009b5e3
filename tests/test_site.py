"""The documentation site: it builds without a warning, and describes every public name."""

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from outputs_support import corrected

import gyrodrift
from gyrodrift.config.model import load_config
from gyrodrift.outputs.fields import CHOICES
from gyrodrift.outputs.json_line import json_line

ROOT = Path(__file__).parent.parent

pytestmark = pytest.mark.xdist_group("site")  # it is built once


def sphinx_options() -> list[str]:
    """The options that `make docs` gives."""
    makefile = (ROOT / "Makefile").read_text()
    stated = re.search(r"^SITE := -m sphinx (.*)$", makefile, re.MULTILINE)
    assert stated, "the Makefile has the options"
    return stated[1].split()


def build(folder: Path, root: Path = ROOT) -> "subprocess.CompletedProcess[str]":
    words = [sys.executable, "-m", "sphinx", *sphinx_options(), "--doctree-dir", str(folder / "trees")]
    environment = {**os.environ, "PYTHONWARNINGS": "ignore"}
    words += [str(root), str(folder / "site")]
    return subprocess.run(words, cwd=root, env=environment, capture_output=True, text=True, check=False)


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    for package in ("sphinx", "myst_parser", "numpydoc", "furo"):
        pytest.importorskip(package, reason="the site needs the extra docs")
    folder = tmp_path_factory.mktemp("site")
    done = build(folder)
    assert (done.returncode, done.stderr) == (0, "")
    return folder / "site"


@pytest.mark.promise("Installation and systems")
def test_every_page_is_built(site: Path) -> None:
    """The docs site builds without warnings and broken links."""
    pages = [*ROOT.glob("*.md"), ROOT / "benchmark" / "README.md", *(ROOT / "docs").rglob("*.md")]
    missing = [page for page in pages if not (site / page.relative_to(ROOT)).with_suffix(".html").exists()]
    assert missing == []
    assert "README.html" in (site / "index.html").read_text()


def test_a_reader_can_search_and_a_wrong_address_has_a_page(site: Path) -> None:
    """The page for wrong addresses leads to the front page and to the search."""
    assert (site / "searchindex.js").stat().st_size > 10_000
    assert 'role="search"' in (site / "docs" / "service.html").read_text()
    page = (site / "404.html").read_text()
    assert "No such page" in page
    assert 'href="README.html"' in page


@pytest.mark.parametrize("page", ["service.md", "outputs.md", "library.md"])
def test_samples_of_lines_have_the_keys_of_the_code(page: str) -> None:
    """Each JSON line of a sample on a page has keys that the table of fields knows, in its order."""
    lines = re.findall(r'^\{"seq".*\}$', (ROOT / "docs" / page).read_text(), re.MULTILINE)
    known = list(json.loads(json_line(corrected(seq=1)))) + list(CHOICES)
    assert [key for line in lines for key in json.loads(line) if key not in known] == []


def test_samples_of_configs_are_read(tmp_path: Path) -> None:
    """Each block of a whole config on the page of the service."""
    blocks = re.findall(r"^```yaml\n(.*?)^```$", (ROOT / "docs" / "service.md").read_text(), re.MULTILINE | re.DOTALL)
    assert len(blocks) >= 2
    for number, block in enumerate(blocks):
        path = tmp_path / f"{number}.yaml"
        path.write_text(block)
        load_config(path)


def test_every_public_name_is_described(site: Path) -> None:
    """The page of the Python interface has an entry for each, with text from its docstring."""
    page = (site / "docs" / "api.html").read_text()
    names = [name for name in gyrodrift.__all__ if name != "__version__"]
    entries = set(re.findall(r'id="gyrodrift\.(\w+)"', page))
    assert set(names) <= entries


def test_a_link_that_leads_nowhere_fails_the_build(tmp_path: Path) -> None:
    """A page, a heading and a file that are missing."""
    pytest.importorskip("furo", reason="the site needs the extra docs")
    shutil.copytree(ROOT / "docs" / "_templates", tmp_path / "docs" / "_templates")
    for name in ("conf.py", "README.md"):
        text = (ROOT / "docs" / name).read_text()
        (tmp_path / "docs" / name).write_text(text.partition("\n## ")[0] if name == "README.md" else text)
    links = "[page](absent.md) [heading](docs/README.md#absent) [file](absent.py)"
    (tmp_path / "README.md").write_text(f"# Title\n\n{links}\n")
    (tmp_path / "docs" / "glossary.md").write_text("---\norphan: true\n---\n\n# Glossary\n")
    done = build(tmp_path / "build", tmp_path)
    assert done.returncode == 1
    assert done.stderr.count("myst.xref_missing") == 3
