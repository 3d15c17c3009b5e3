"""Files for contributors and for other tools: the tour, citation, pre-commit, container, and hosted checks."""

import json
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml
from distribution_support import ROOT, run, run_online, tool

from gyrodrift.cli import parser_of

FILE = re.compile(r"[\w.-]+(?:/[\w.-]+)*(?:/|\.(?:py|md|toml|lock|svg))")


def read(name: str) -> str:
    return (ROOT / name).read_text()


def extras() -> set[str]:
    return set(tomllib.loads(read("pyproject.toml"))["project"]["optional-dependencies"])


def make_targets() -> set[str]:
    """Targets of the Makefile, files of the environment among them."""
    text = read("Makefile").replace("$(VENV)", ".venv")
    return set(re.findall(r"^([\w./-]+):", text, re.MULTILINE))


def is_there(name: str) -> bool:
    return any((folder / name).exists() for folder in (ROOT, ROOT / "gyrodrift"))


def test_the_tour_names_files_that_exist() -> None:
    named = [code for code in re.findall(r"`([^`\n]+)`", read("CONTRIBUTING.md")) if FILE.fullmatch(code)]
    in_picture = re.findall(r'class="path"[^>]*>([^<]+)<', read("docs/data-flow.svg"))
    assert len(named) > 25
    assert len(in_picture) > 12
    assert [name for name in (*named, *in_picture) if not is_there(name)] == []


def test_the_citation_is_of_the_newest_release() -> None:
    """Version and date are those of the changelog."""
    citation = yaml.safe_load(read("CITATION.cff"))
    release = re.search(r"^## ([\d.]+) — (\S+)$", read("docs/CHANGELOG.md"), re.MULTILINE)
    assert release, "the changelog has a dated release"
    assert (citation["version"], str(citation["date-released"])) == release.groups()
    assert {"cff-version", "message", "title", "authors", "license"} <= citation.keys()


def hooks() -> Iterator[dict[str, Any]]:
    for repository in yaml.safe_load(read(".pre-commit-config.yaml"))["repos"]:
        yield from repository["hooks"]


def test_a_commit_is_checked_by_programs_of_the_tests() -> None:
    entries = [shlex.split(hook["entry"]) for hook in hooks()]
    programs = {Path(words[0]).name for words in entries}
    assert {words[0] for words in entries} == {f".venv/bin/{name}" for name in programs}
    assert programs == {"ruff", "mypy", "pytest"}
    assert [
        word for words in entries for word in words if word.startswith("tests/") and not (ROOT / word).exists()
    ] == []


def instructions() -> list[list[str]]:
    """Instructions of the Dockerfile with their words, without comments."""
    text = re.sub(r"^#.*\n", "", read("Dockerfile"), flags=re.MULTILINE).replace("\\\n", " ")
    return [shlex.split(line) for line in text.splitlines() if line.strip()]


def test_the_container_copies_files_that_exist() -> None:
    copies = [words[1:-1] for words in instructions() if words[0] == "COPY" and not words[1].startswith("--from")]
    sources = {source for words in copies for source in words}
    let_through = {line[1:] for line in read(".dockerignore").splitlines() if line.startswith("!")}
    assert sources == let_through
    assert [source for source in sources if not (ROOT / source).exists()] == []


def test_the_container_is_built_from_stated_versions_and_runs_as_a_user() -> None:
    lines = instructions()
    allowed = {"FROM", "RUN", "WORKDIR", "COPY", "ENV", "USER", "EXPOSE", "ENTRYPOINT", "CMD"}
    assert {words[0] for words in lines} <= allowed
    images = [words[1] for words in lines if words[0] == "FROM"]
    assert all(re.fullmatch(r"python:3\.\d+-slim-\w+", image) for image in images)
    assert "uv==" in read("Dockerfile")
    assert read("Dockerfile").count("--no-cache") == 2
    users = [index for index, words in enumerate(lines) if words[0] == "USER"]
    assert users
    assert [words[0] for words in lines[users[-1] :] if words[0] in ("RUN", "COPY")] == []
    assert re.search(r'^ENTRYPOINT \["gyrodrift"\]$', read("Dockerfile"), re.MULTILINE)


def test_hadolint_finds_nothing_in_the_dockerfile() -> None:
    done = run(tool("hadolint"), "--no-color", "Dockerfile")
    assert (done.returncode, done.stdout) == (0, "")


def test_the_commands_of_the_container_install_a_program_that_runs(tmp_path: Path) -> None:
    for source in (line[1:] for line in read(".dockerignore").splitlines() if line.startswith("!")):
        copy = shutil.copytree if (ROOT / source).is_dir() else shutil.copyfile
        copy(ROOT / source, tmp_path / source)
    (sync,) = (words[1:] for words in instructions() if words[:3] == ["RUN", "uv", "sync"])
    named = {sync[index + 1] for index, word in enumerate(sync) if word == "--extra"}
    assert named <= extras()
    sync.remove("--no-cache")
    settings = {"UV_PROJECT_ENVIRONMENT": str(tmp_path / "opt"), "UV_PYTHON": sys.executable}
    done = run_online(tool("uv"), *sync[1:], folder=tmp_path, environment=settings)
    assert done.returncode == 0, done.stderr
    program = tmp_path / "opt" / "bin" / "gyrodrift"
    demo = subprocess.run(
        [program, "demo", "--duration", "2", "--speed", "20"], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert "gyrodrift        mean |error|" in demo.stdout


def test_the_devcontainer_sets_up_what_the_tests_need() -> None:
    container = json.loads(read(".devcontainer/devcontainer.json"))
    program, target = container["postCreateCommand"].split()
    assert program == "make"
    assert target in make_targets()
    assert container["forwardPorts"] == [8117]


def steps() -> list[str]:
    """Commands of the hosted checks."""
    workflow = yaml.safe_load(read(".github/workflows/ci.yml"))
    return [step["run"] for job in workflow["jobs"].values() for step in job["steps"] if "run" in step]


def test_hosted_checks_run_the_two_commands_of_the_readme() -> None:
    """`make demo` and `make test`, and nothing that the tests do not have."""
    assert steps()[:2] == ["make demo", "make test"]
    named = [command.split()[1] for command in steps() if command.startswith("make ")]
    assert set(named) <= make_targets()


def test_hosted_checks_give_commands_that_are_understood() -> None:
    commands = [shlex.split(command)[1:] for command in steps() if command.startswith("gyrodrift ")]
    assert {words[0] for words in commands} >= {"info", "filter", "compare", "tune", "diagnose"}
    for name, *arguments in commands:
        assert vars(parser_of(name).read(arguments))


def test_hosted_checks_run_on_pythons_of_the_project() -> None:
    workflow = yaml.safe_load(read(".github/workflows/ci.yml"))
    versions = workflow["jobs"]["linux"]["strategy"]["matrix"]["python"]
    classifiers = tomllib.loads(read("pyproject.toml"))["project"]["classifiers"]
    assert {f"Programming Language :: Python :: {version}" for version in versions} <= set(classifiers)


@pytest.mark.parametrize("name", ["CONTRIBUTING.md", "SECURITY.md", "CITATION.cff", "LICENSE", "docs/CHANGELOG.md"])
def test_every_file_that_a_stranger_looks_for_is_there(name: str) -> None:
    assert (ROOT / name).stat().st_size > 400
