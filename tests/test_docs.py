"""The pages for people: their links lead somewhere, and the commands they name are those that there are."""

import pkgutil
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import promises
import pytest
from test_architecture import ROOMS

from gyrodrift.cli import COMMANDS, parser_of
from gyrodrift.cli.plug_ins import REGISTRIES
from gyrodrift.values.errors import UsageError

ROOT = Path(__file__).parent.parent
DOCS = ROOT / "docs"
PAGES = sorted([*ROOT.glob("*.md"), *ROOT.glob("benchmark/*.md"), *DOCS.rglob("*.md")])
NAMES = [*COMMANDS, "gyrogap"]
"""Commands here, and that of the package in benchmark/, which `make test` installs."""

SOURCES = sorted([*(ROOT / "gyrodrift").rglob("*.py"), *(ROOT / "firmware_sim").rglob("*.py")])
EQUATIONS = 11
"""1 to 8 are HDR, 9 PI, 10 E, 11 NE."""

FENCE = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
CODE = re.compile(r"`([^`\n]+)`")
LINK = re.compile(r"\]\(([^)\s]+)\)")
OPTION = re.compile(r"--[a-z][a-z-]*")


def name_of(path: Path) -> str:
    return str(path.relative_to(ROOT))


def prose(page: Path) -> str:
    """The page without its code blocks."""
    return FENCE.sub("", page.read_text())


def links(page: Path) -> list[str]:
    """Targets of links and pictures that are not on the network."""
    return [target for target in LINK.findall(CODE.sub("", prose(page))) if not re.match(r"[a-z]+:", target)]


@cache
def anchors(page: Path) -> frozenset[str]:
    text, result = prose(page), set[str]()
    for heading in re.findall(r"^#+ (.+)$", text, re.MULTILINE):
        shown = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)
        slug = re.sub(r"[^\w\- ]", "", shown.lower()).strip().replace(" ", "-")
        copies = sum(re.fullmatch(rf"{re.escape(slug)}(-\d+)?", expected) is not None for expected in result)
        result.add(f"{slug}-{copies}" if slug in result else slug)
    return frozenset(result | set(re.findall(r'<a id="([^"]+)">', text)))


def shell_lines(page: Path) -> Iterator[list[str]]:
    """The words of each command in a page's sh blocks, up to a pipe."""
    for language, block in FENCE.findall(page.read_text()):
        if language == "sh":
            for line in block.replace("\\\n", " ").splitlines():
                words = [word for word in shlex.split(line, comments=True) if word != "&"]
                words = words[: words.index("|")] if "|" in words else words
                if words:
                    yield words


@cache
def options_of(command: str) -> set[str]:
    return set(OPTION.findall(parser_of(command).format_help()))


@cache
def options_of_module(module: str) -> frozenset[str]:
    done = subprocess.run(
        [sys.executable, "-m", module, "--help"], cwd=ROOT, capture_output=True, text=True, check=True
    )
    return frozenset(OPTION.findall(done.stdout))


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_links_lead_somewhere(page: Path) -> None:
    """A relative link names a file that exists, and its anchor a heading or an id of that file."""
    for target in links(page):
        path, _, anchor = target.partition("#")
        file = (page.parent / path).resolve() if path else page
        assert file.exists(), f"{target}: there is no such file"
        if anchor:
            assert anchor in anchors(file), f"{target}: there is no such heading in {name_of(file)}"


def test_every_page_is_in_the_index() -> None:
    """docs/README.md links to every other page of docs."""
    listed = {(DOCS / target.partition("#")[0]).resolve() for target in links(DOCS / "README.md")}
    assert {name_of(page) for page in PAGES if page.is_relative_to(DOCS) and page not in listed} == {"docs/README.md"}


def test_every_picture_is_shown() -> None:
    shown = {(page.parent / target).resolve() for page in PAGES for target in links(page)}
    pictures = [*DOCS.rglob("*.png"), *DOCS.rglob("*.svg")]
    assert pictures
    assert [name_of(picture) for picture in pictures if picture not in shown] == []


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_commands_in_code_blocks_are_understood(page: Path) -> None:
    """A command line of ours parses as it stands; a recipe's toy names only have to stand behind options that exist."""
    for program, *words in shell_lines(page):
        if Path(program).name == "gyrodrift":
            command, *arguments = words
            assert command in NAMES, f"gyrodrift {command}: there is no such command"
            if page.name.startswith("extending-"):
                assert set(OPTION.findall(" ".join(arguments))) <= options_of(command)
                continue
            try:
                parser_of(command).read(arguments)
            except UsageError as error:
                pytest.fail(f"gyrodrift does not take: {shlex.join(words)}: {error}")
        elif program == "python" and words[0] == "-m" and words[1].startswith(("firmware_sim", "gyrodrift")):
            assert set(OPTION.findall(" ".join(words[2:]))) <= options_of_module(words[1])


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_commands_and_options_in_the_text_exist(page: Path) -> None:
    """`gyrodrift COMMAND --option` names a command and its options; an option alone is one of some command."""
    expected = set(OPTION.findall("--help --version")) | options_of_module("firmware_sim")
    expected |= {option for command in NAMES for option in options_of(command)}
    for code in CODE.findall(prose(page)):
        words = code.split()
        named = set(OPTION.findall(code))
        if words[0] == "gyrodrift" and len(words) > 1 and not words[1].startswith("-"):
            assert words[1] in NAMES, f"{code}: there is no such command"
            assert named <= options_of(words[1]), code
        elif words[0].startswith("--"):
            assert named <= expected, f"{code}: no command has it"


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_what_is_to_be_run_or_read_exists(page: Path) -> None:
    """Tests, configs and sources that a page names by path, but for toys and old names, and targets of make."""
    if not page.name.startswith(("extending-", "CHANGELOG")):
        for path in re.findall(r"\b(?:benchmark|tests|config|gyrodrift)/[\w./-]+\.(?:py|yaml)\b", page.read_text()):
            assert (ROOT / path).exists(), f"{path}: there is no such file"
    targets = set(re.findall(r"^([\w-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE))
    for program, *words in shell_lines(page):
        if program == "make":
            assert set(words) <= targets


def test_promises_are_those_of_the_tests() -> None:
    """docs/promises.csv is what the tests promise; `python tests/promises.py` writes it."""
    listed = promises.listed()
    assert promises.LIST.read_text() == listed
    assert listed.count("\n") > 200


PATH = re.compile(r"(?:[\w.-]+/)*[\w.-]+(?:\.(?:py|md|toml|json|yaml|png)|/)")
PACKAGE = re.compile(r".{14}(\w+)/ +(.+)")
"""A line of the drawing: the stage, or blanks, then the package and its content."""


@cache
def tree() -> frozenset[str]:
    """Files of the project and their folders, with a slash before and, for a folder, behind the path."""
    done = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        pytest.skip("the tree is no clone")
    files = [Path(line) for line in done.stdout.splitlines()]
    return frozenset([*(f"/{file}" for file in files), *(f"/{folder}/" for file in files for folder in file.parents)])


def drawing() -> dict[str, str]:
    """Content of each package in the drawing of docs/extending.md, from top to bottom."""
    (block,) = [text for _, text in FENCE.findall((DOCS / "extending.md").read_text()) if " cli/ " in text]
    packages: dict[str, str] = {}
    for line in filter(None, block.splitlines()):
        if match := PACKAGE.fullmatch(line):
            packages[match[1]] = match[2]
        else:
            packages[next(reversed(packages))] += f" {line.strip()}"
    return packages


@pytest.mark.parametrize("page", sorted(DOCS.glob("extending*.md")), ids=name_of)
def test_files_modules_and_classes_of_the_recipes_exist(page: Path) -> None:
    """A path may be shortened from the left; a name with NAME in it is a toy of the reader."""
    text = "".join(path.read_text() for path in (*SOURCES, *DOCS.glob("examples/*.py")))
    for code in CODE.findall(prose(page)):
        if "NAME" in code or code in (*REGISTRIES, "gyrodrift.commands"):
            continue
        if PATH.fullmatch(code):
            assert any(path.endswith(f"/{code}") for path in tree()), f"{code}: there is no such file"
        elif re.fullmatch(r"gyrodrift(?:\.\w+)+", code):
            assert pkgutil.resolve_name(code) is not None
        elif re.fullmatch(r"(?:\w+\.)?[A-Z]\w*[a-z]\w*", code):
            assert re.search(rf"\b{code.rpartition('.')[2]}\b", text), f"{code}: no source has it"


def test_the_drawing_has_the_packages_of_today() -> None:
    packages = drawing()
    folders = {path.parent.name for path in (ROOT / "gyrodrift").glob("*/__init__.py")}
    assert packages.keys() == folders | {"firmware_sim"}
    for package, content in packages.items():
        folder = ROOT / package if package == "firmware_sim" else ROOT / "gyrodrift" / package
        named = re.findall(r"\w+/|\w+\.py", content)
        assert [name for name in named if not (folder / name).exists()] == [], package
    order = list(packages)
    for package, below in ((name.split(".")[0], spaces.split()) for name, spaces in ROOMS.items()):
        if package in order and package != "session":  # its checks use facts, as the drawing says
            imported = {space.split(".")[0] for space in below} & packages.keys() - {package}
            assert [space for space in imported if order.index(space) < order.index(package)] == [], package


def test_equations_that_the_code_cites_stand_in_the_docs() -> None:
    """docs/filters.md has an anchor for each equation, and the code names the page that they stand on."""
    assert {f"equation-{number}" for number in range(1, EQUATIONS + 1)} <= anchors(DOCS / "filters.md")
    cited = [name_of(path) for path in SOURCES if re.search(r"[Ee]quation[^.\n]*of the README", path.read_text())]
    assert cited == [], "the equations stand in docs/filters.md"
