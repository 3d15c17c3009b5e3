"""The sdist and the wheel of this clone, built once for all tests of one worker."""

import atexit
import shutil
import subprocess
import sys
import tarfile
import tempfile
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent


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
    _build("sdist", ROOT, folder)
    (sdist,) = folder.glob("*.tar.gz")
    with tarfile.open(sdist) as archive:
        archive.extractall(folder, filter="data")
    _build("wheel", folder / sdist.name.removesuffix(".tar.gz"), folder)
    (wheel,) = folder.glob("*.whl")
    return Distributions(sdist, wheel)


def _build(target: str, source: Path, folder: Path) -> None:
    words = [sys.executable, "-m", "hatchling", "build", "--target", target, "--directory", str(folder)]
    subprocess.run(words, cwd=source, capture_output=True, check=True)
