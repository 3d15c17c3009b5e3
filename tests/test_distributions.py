"""The sdist and the wheel: checked as an index checks them, and run through uvx and pipx; and the lock file."""

import re
import sys
import tarfile
import tomllib
import zipfile
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest
from distribution_support import ROOT, build, built_distributions, run, run_online, tool

pytestmark = pytest.mark.xdist_group("wheel")  # it is built once

PUBLIC_HOSTS = {"pypi.org", "files.pythonhosted.org"}
DEMO = ("gyrodrift", "demo", "--duration", "2", "--speed", "20")


@pytest.mark.packaging
def test_twine_accepts_both() -> None:
    """Metadata and the long description are those that an index renders."""
    pytest.importorskip("twine", reason="the extra test brings it")
    built = built_distributions()
    done = run(sys.executable, "-m", "twine", "check", "--strict", built.sdist, built.wheel)
    assert done.returncode == 0, done.stdout
    assert done.stdout.count("PASSED") == 2


@pytest.mark.packaging
def test_the_wheel_holds_what_a_wheel_should() -> None:
    """check-wheel-contents finds nothing but what pyproject.toml excuses."""
    done = run(tool("check-wheel-contents"), built_distributions().wheel)
    assert done.returncode == 0, done.stdout
    assert done.stdout.rstrip().endswith("OK")


@pytest.mark.packaging
def test_the_wheel_of_the_sdist_has_all_of_the_clone() -> None:
    """Every file of both packages that is not compiled by Python."""
    with zipfile.ZipFile(built_distributions().wheel) as wheel:
        names = set(wheel.namelist())
    sources = [path for package in ("gyrodrift", "firmware_sim") for path in (ROOT / package).rglob("*")]
    files = {str(path.relative_to(ROOT)) for path in sources if path.is_file() and "__pycache__" not in path.parts}
    assert files - names == set()


@pytest.mark.packaging
def test_the_sdist_has_what_a_packager_needs() -> None:
    """License, tests, docs, the lock file and the shipped configs, and nothing of this machine."""
    with tarfile.open(built_distributions().sdist) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
    assert {"LICENSE", "README.md", "Makefile", "pyproject.toml", "uv.lock", "config/rig.yaml"} <= names
    assert {"docs/CHANGELOG.md", "tests/test_distributions.py"} <= names
    assert [name for name in names if name.startswith((".venv", "build/", "dist/")) or "node_modules" in name] == []


@pytest.mark.packaging
def test_the_wheel_of_gyrogap_adds_its_command(tmp_path: Path) -> None:
    pytest.importorskip("hatchling", reason="building a wheel needs the test extra")
    build("wheel", ROOT / "benchmark", tmp_path)
    (wheel,) = tmp_path.glob("gyrogap-*.whl")
    with zipfile.ZipFile(wheel) as archive:
        tops = {name.partition("/")[0].partition("-")[0] for name in archive.namelist()}
        (entries,) = (name for name in archive.namelist() if name.endswith("entry_points.txt"))
        assert archive.read(entries).decode().split() == ["[gyrodrift.commands]", "gyrogap", "=", "gyrogap.command"]
    assert tops == {"gyrogap"}


@pytest.mark.promise("Installation and systems")
@pytest.mark.packaging
def test_uvx_runs_the_demo_from_the_clone(tmp_path: Path) -> None:
    """`uvx --from . gyrodrift demo` runs from the clone."""
    uvx, fresh = tool("uvx"), ("--python", sys.executable, "--refresh-package", "gyrodrift")
    demo = run_online(uvx, *fresh, "--from", ".", *DEMO)
    assert demo.returncode == 0, demo.stderr
    assert "gyrodrift        mean |error|" in demo.stdout
    tune = run_online(
        uvx, *fresh[:2], "--from", ".", "gyrodrift", "tune", ROOT / "config", "--out", tmp_path / "x.yaml"
    )
    assert tune.returncode == 2
    assert tune.stderr.endswith(f": uvx --from '{ROOT}[lab]' gyrodrift\n")


@pytest.mark.promise("Installation and systems")
@pytest.mark.packaging
def test_pipx_installs_the_wheel(tmp_path: Path) -> None:
    """`pipx install` of the wheel brings the command."""
    pytest.importorskip("pipx", reason="the extra test brings it")
    pipx = (sys.executable, "-m", "pipx")
    wheel = built_distributions().wheel
    homes = {"PIPX_HOME": str(tmp_path / "home"), "PIPX_BIN_DIR": str(tmp_path / "bin"), "PIPX_MAN_DIR": str(tmp_path)}
    done = run_online(*pipx, "install", "--backend", "uv", "--python", sys.executable, wheel, environment=homes)
    assert done.returncode == 0, done.stderr
    command = tmp_path / "bin" / "gyrodrift"
    demo = run(command, *DEMO[1:])
    assert "gyrodrift        mean |error|" in demo.stdout
    tune = run(command, "tune", ROOT / "config", "--out", tmp_path / "x.yaml")
    assert tune.returncode == 2
    assert tune.stderr.endswith(f": pipx install --force '{wheel}[lab]'\n")


def locked() -> dict[str, Any]:
    return tomllib.loads((ROOT / "uv.lock").read_text())


def project() -> dict[str, Any]:
    table: dict[str, Any] = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    return table


def test_the_lock_file_names_public_hosts_alone() -> None:
    hosts = {urlsplit(url).hostname for url in re.findall(r'"(\w+://[^"]+)"', (ROOT / "uv.lock").read_text())}
    assert hosts == PUBLIC_HOSTS


@pytest.mark.promise("Installation and systems")
def test_the_lock_file_fits_the_project() -> None:
    """The lock file fits the project."""
    requirements = pytest.importorskip("packaging.requirements", reason="the extra test brings it")
    versions: dict[str, set[str]] = {}
    for package in locked()["package"]:
        versions.setdefault(package["name"], set()).add(package.get("version", ""))
    extras = project()["optional-dependencies"]
    stated = [*project()["dependencies"], *(text for texts in extras.values() for text in texts)]
    parsed = [requirements.Requirement(text) for text in stated]
    canonical = {requirement: re.sub(r"[-_.]+", "-", requirement.name).lower() for requirement in parsed}
    unmet = [
        str(requirement)
        for requirement in parsed
        if not any(map(requirement.specifier.contains, versions.get(canonical[requirement], ())))
    ]
    assert unmet == []
    assert locked()["requires-python"] == project()["requires-python"]


def test_a_package_has_an_upper_bound_or_a_reason_to_have_none() -> None:
    """Packages without a bound number their releases by date, or keep old interfaces over major releases."""
    requirements = pytest.importorskip("packaging.requirements", reason="the extra test brings it")
    extras = project()["optional-dependencies"]
    tools = {"test", "docs", "fuzz"}
    used = [*project()["dependencies"], *(text for name in set(extras) - tools for text in extras[name])]
    unbounded = {requirements.Requirement(text).name for text in used if "<" not in text}
    assert unbounded == {"distributed", "pyarrow", "rich", "structlog", "websockets"}
