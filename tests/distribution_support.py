"""The sdist and the wheel of this clone, built once for all tests of one worker, and programs that install them."""

import atexit
import os
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
NONE: Mapping[str, str] = {}

NO_NETWORK = re.compile(r"dns error|failed to fetch|connect|network|timed? ?out|NewConnectionError", re.IGNORECASE)
UV = {
    "UV_CACHE_DIR": f"{sys.prefix}/uv-cache",  # kept between runs; `make clean` removes it
    "UV_HTTP_TIMEOUT": "30",
    "UV_SYSTEM_CERTS": "true",  # as pip: an index behind a proxy has a certificate of the machine
}


@dataclass(frozen=True)
class Distributions:
    """Paths of the sdist and of the wheel that was built from the sdist."""

    sdist: Path
    wheel: Path


@cache
def built_distributions() -> Distributions:
    """Build the sdist from the clone and the wheel from the sdist, as an index and its users do."""
    pytest.importorskip("hatchling", reason="building a wheel needs the test extra")
    folder = Path(tempfile.mkdtemp(prefix="gyrodrift-dist-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    build("sdist", ROOT, folder)
    (sdist,) = folder.glob("*.tar.gz")
    with tarfile.open(sdist) as archive:
        archive.extractall(folder, filter="data")
    build("wheel", folder / sdist.name.removesuffix(".tar.gz"), folder)
    (wheel,) = folder.glob("*.whl")
    return Distributions(sdist, wheel)


def build(target: str, source: Path, folder: Path) -> None:
    """Build the `sdist` or the `wheel` of a project into a folder."""
    words = [sys.executable, "-m", "hatchling", "build", "--target", target, "--directory", str(folder)]
    subprocess.run(words, cwd=source, capture_output=True, check=True)


def tool(name: str) -> str:
    """Path of a program of the extra test, or of this machine."""
    path = shutil.which(name, path=f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}")
    if path is None:
        pytest.skip(f"{name} is not installed; the extra test brings it")
    return path


def run(
    *words: str | Path, folder: Path = ROOT, environment: Mapping[str, str] = NONE
) -> "subprocess.CompletedProcess[str]":
    without_clone = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "VIRTUAL_ENV")}
    return subprocess.run(
        [*map(str, words)],
        cwd=folder,
        env={**without_clone, **environment},
        capture_output=True,
        text=True,
        check=False,
    )


def run_online(
    *words: str | Path, folder: Path = ROOT, environment: Mapping[str, str] = NONE
) -> "subprocess.CompletedProcess[str]":
    """Run a command that fetches packages; skip the test if no index answers."""
    done = run(*words, folder=folder, environment={**UV, **environment})
    if done.returncode and NO_NETWORK.search(done.stderr):
        pytest.skip(f"no index of packages answers: {done.stderr.strip().splitlines()[-1]}")
    return done
