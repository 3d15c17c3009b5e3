"""The files of a release: built twice, examined by their own checkers, installed and removed."""

import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import tarfile
import venv
from pathlib import Path

import pytest
from distribution_support import ROOT, built_distributions, run
from plug_in_support import EXAMPLES

from gyrodrift import __version__

pytestmark = [pytest.mark.packaging, pytest.mark.xdist_group("release")]  # it is built once

UNIT = Path("/etc/systemd/system/gyrodrift.service")


def released(folder: Path) -> "subprocess.CompletedProcess[str]":
    return run(sys.executable, ".ci/release.py", folder, environment={"PYTHONPATH": str(ROOT)})


@pytest.fixture(scope="module")
def dist(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("dist")
    done = released(folder)
    assert done.returncode == 0 or "no .deb" in done.stderr, done.stderr
    return folder


@pytest.fixture
def package(dist: Path) -> Path:
    """The .deb; tests that install it need root and a machine that nobody has installed it on."""
    packages = list(dist.glob("*.deb"))
    if not packages:
        pytest.skip("no .deb: Debian's tools are missing")
    return packages[0]


@pytest.fixture
def root_only() -> None:
    if os.geteuid() != 0 or shutil.which("gyrodrift", path="/usr/bin") or UNIT.exists():
        pytest.skip("needs root, and no gyrodrift in the system")


def test_all_files_are_there_with_their_checksums(dist: Path) -> None:
    lines = (dist / "SHA256SUMS").read_text().splitlines()
    sums = {name: digest for digest, _, name in (line.partition("  ") for line in lines)}
    assert {f"gyrodrift-c-{__version__}.tar.gz", f"gyrodrift-{__version__}.cdx.json"} <= sums.keys()
    assert sums == {name: hashlib.sha256((dist / name).read_bytes()).hexdigest() for name in sums}


def test_wheel_sdist_and_archive_are_the_same_bytes_each_time(dist: Path, tmp_path: Path) -> None:
    code = "import sys; sys.path.insert(0, '.ci'); import release, pathlib; out = pathlib.Path(sys.argv[1]); "
    code += "release.wheel_and_sdist(out); release.c_library(out); release.sbom(out)"
    done = run(sys.executable, "-c", code, tmp_path, environment={"PYTHONPATH": str(ROOT)})
    assert done.returncode == 0, done.stderr
    second = sorted(tmp_path.iterdir())
    assert len(second) == 4
    assert [path.name for path in second if path.read_bytes() != (dist / path.name).read_bytes()] == []


def test_the_sbom_names_what_the_lock_file_pins(dist: Path) -> None:
    content = json.loads((dist / f"gyrodrift-{__version__}.cdx.json").read_text())
    assert (content["bomFormat"], content["specVersion"]) == ("CycloneDX", "1.6")
    names = {component["name"] for component in content["components"]}
    assert {"numpy", "pyserial", "mcap", "uplot"} <= names
    references = {item["ref"] for item in content["dependencies"]}
    assert {name for item in content["dependencies"] for name in item["dependsOn"]} <= references


def test_the_c_archive_has_each_form(dist: Path, tmp_path: Path) -> None:
    with tarfile.open(dist / f"gyrodrift-c-{__version__}.tar.gz") as archive:
        archive.extractall(tmp_path, filter="data")
    top = tmp_path / f"gyrodrift-c-{__version__}"
    forms = ["gyrodrift.h", "LICENSE", "arduino/gyrodrift/library.properties", "platformio/gyrodrift/library.json"]
    forms += ["esp-idf/gyrodrift/idf_component.yml", "zephyr/gyrodrift/zephyr/module.yml"]
    assert [form for form in forms if not (top / form).is_file()] == []
    platformio = shutil.which("pio", path=f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}")
    if platformio is not None:
        done = run(platformio, "pkg", "pack", folder=top / "platformio" / "gyrodrift")
        assert done.returncode == 0 or "Could not load SPDX licenses" in done.stderr, done.stderr  # it asks a server
    if shutil.which("compote") is not None:
        assert (
            run("compote", "component", "pack", "--name", "gyrodrift", folder=top / "esp-idf" / "gyrodrift").returncode
            == 0
        )


def test_lintian_finds_nothing(package: Path) -> None:
    if shutil.which("lintian") is None:
        pytest.skip("no lintian")
    done = run("lintian", "--allow-root", "--fail-on", "error,warning", package)
    assert (done.returncode, done.stdout) == (0, "")


@pytest.mark.usefixtures("root_only")
def test_the_package_is_installed_upgraded_and_purged(package: Path) -> None:
    """The service has its user and its unit, and nothing stays but the user."""
    try:
        for _ in ("installed", "upgraded"):
            done = run("dpkg", "--install", package)
            assert done.returncode == 0, done.stderr
        version = run("/usr/bin/gyrodrift", "--version").stdout
        assert version.startswith(f"gyrodrift {__version__} from /usr/lib/gyrodrift/gyrodrift ")
        assert run("id", "--groups", "--name", "gyrodrift").stdout.split() == ["gyrodrift", "dialout"]
        assert Path("/usr/share/man/man5/gyrodrift-config.5.gz").is_file()
        if shutil.which("systemd-analyze"):
            assert run("systemd-analyze", "verify", "gyrodrift.service").returncode == 0
        demo = run("/usr/bin/gyrodrift", "demo", "--duration", "2", "--speed", "20")
        assert "gyrodrift        mean |error|" in demo.stdout
    finally:
        done = run("dpkg", "--purge", "gyrodrift")
    assert done.returncode == 0, done.stderr
    removed = (
        "/usr/bin/gyrodrift",
        "/usr/lib/gyrodrift",
        "/etc/gyrodrift",
        "/etc/default/gyrodrift",
        "/var/lib/gyrodrift",
    )
    assert [path for path in removed if Path(path).exists()] == []


@pytest.mark.usefixtures("root_only")
def test_a_hand_made_install_is_one_line(package: Path) -> None:
    UNIT.parent.mkdir(parents=True, exist_ok=True)
    UNIT.write_text("[Unit]\n")
    try:
        done = run("dpkg", "--install", package)
    finally:
        UNIT.unlink()
        run("dpkg", "--purge", "gyrodrift")
    assert done.returncode != 0
    (line,) = (line for line in done.stderr.splitlines() if line.startswith("gyrodrift: "))
    assert re.search(r"hand-made install .*; stop and disable that service, remove the file .* install again$", line)


def test_each_plug_in_of_the_docs_is_installed_and_found(tmp_path: Path) -> None:
    """Pip installs them into an environment of its own, with the wheel of this clone."""
    venv.create(tmp_path / "venv", with_pip=False)
    python = tmp_path / "venv" / "bin" / "python"
    (site,) = (tmp_path / "venv" / "lib").glob("python*/site-packages")
    (site / "of-the-tests.pth").write_text("".join(f"{p}\n" for p in sys.path if p.endswith("site-packages")))
    install = [sys.executable, "-m", "pip", "--python", str(python), "install", "--no-deps", "--no-index"]
    examples = [shutil.copytree(kind, tmp_path / kind.name) for kind in sorted(EXAMPLES.iterdir())]
    done = run(*install, "--no-build-isolation", built_distributions().wheel, *examples)
    assert done.returncode == 0, done.stderr
    listed = run(python, "-m", "gyrodrift", "help", folder=tmp_path).stdout
    names = ("output yaw_file: ", "source pipe: ", "protocol milli: ", "filter fixed: ", "effect motor_current: ")
    assert [name for name in (*names, "last-yaw") if name not in listed] == []
    simulated = run(python, "-m", "gyrodrift", "simulate", "--out", "s", "--minutes", "0.05", folder=tmp_path)
    assert simulated.returncode == 0, simulated.stderr
    done = run(python, "-m", "gyrodrift", "last-yaw", "s/session-01.mcap", folder=tmp_path)
    assert re.fullmatch(r"-?\d+\.\d{3} deg\n", done.stdout), done.stderr
