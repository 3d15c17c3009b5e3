"""How this copy of gyrodrift is installed, and the command that adds a package to it.

A message never names `gyrodrift[extra]` alone unless this copy came from an index: on an index, that name may belong to
another project. It names the clone, the wheel or the address that this copy came from (PEP 610).
"""

import json
import logging
import platform
import re
import shlex
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from enum import Enum
from importlib import import_module
from importlib.metadata import Distribution, PackageNotFoundError, distribution
from importlib.util import find_spec
from pathlib import Path
from urllib.parse import urlsplit
from urllib.request import url2pathname

from gyrodrift import __version__
from gyrodrift.values.errors import DataError, UsageError

NAME = "gyrodrift"
DEVELOPMENT = frozenset({"docs", "fuzz", "test"})
"""Extras that only a clone needs."""
PACKAGE = Path(__file__).parent.parent

PACKAGES_OF = {
    "tune": ("cma", "numba"),
    "diagnose": ("numba", "scipy"),
    "compare": ("cma", "numba", "scipy"),
}
"""Packages of the extra `lab` that each analysis needs."""


class Installer(Enum):
    """Tool that made the environment of this process."""

    PIP = "pip"
    PIPX = "pipx"
    UV_PIP = "uv pip"
    UV_TOOL = "uv tool"
    UVX = "uvx"


REPLACING = frozenset({Installer.PIPX, Installer.UV_TOOL, Installer.UVX})
"""Installers that create a new environment, without the extras that it had."""


@dataclass(frozen=True, slots=True)
class InstallSource:
    """Source that this copy was installed from: a folder, a wheel, an address, or the name in an index."""

    source: str
    is_editable: bool = False

    def with_extra(self, extra: str) -> str:
        """The requirement that stands for this source with an extra."""
        if "://" in self.source:
            return f"{NAME}[{extra}] @ {self.source}"
        return f"{self.source}[{extra}]"


def version_line() -> str:
    """Version, the folder that runs, and the Python that runs it."""
    return f"gyrodrift {__version__} from {PACKAGE} (Python {platform.python_version()}, {sys.executable})"


def extra_command(extra: str) -> str:
    """The command that adds the packages of an extra to this copy, or runs this copy with them."""
    origin, installer = _origin(), _installer()
    if origin is None:
        return package_command(*_packages_of(extra))
    extras = [extra, *_present_extras(extra)] if installer in REPLACING else [extra]
    requirement = shlex.quote(origin.with_extra(",".join(extras)))
    if installer is Installer.UVX:
        return f"uvx --from {requirement} {NAME}"
    editable = "--editable " if origin.is_editable else ""
    commands = {Installer.PIPX: "pipx install --force", Installer.UV_TOOL: "uv tool install --force"}
    return f"{commands.get(installer) or _pip(installer)} {editable}{requirement}"


def package_command(*requirements: str) -> str:
    """The command that adds packages to the environment of this process."""
    words, installer = shlex.join(requirements), _installer()
    if installer is Installer.UVX:
        origin = _origin()
        source = shlex.quote(origin.source if origin else NAME)
        return f"uvx --from {source} {' '.join(f'--with {shlex.quote(word)}' for word in requirements)} {NAME}"
    if installer is Installer.PIPX:
        return f"pipx inject {Path(sys.prefix).name} {words}"
    return f"{_pip(installer)} {words}"


def need_packages(purpose: str, *names: str) -> None:
    """Check before the work begins that packages of the extra `lab` are installed: these, or those of an analysis.

    Raises
    ------
    UsageError
        With the command that installs them.
    """
    logging.getLogger("matplotlib").setLevel(logging.ERROR)  # in a home that cannot be written to it tells its cache
    try:
        for name in names or PACKAGES_OF[purpose]:
            import_module(name)
    except ImportError as error:
        raise UsageError(f"{purpose} needs the package {error.name}: {extra_command('lab')}") from error


@contextmanager
def packages_of(path: Path, extra: str) -> Iterator[None]:
    """Turn the import error of an optional package into an error for the user.

    Raises
    ------
    DataError
        The package is missing; with the command that installs it.
    """
    try:
        yield
    except ImportError as error:
        raise DataError(f"{path}: needs the package {error.name}: {extra_command(extra)}") from error


def _installer() -> Installer:
    prefix = Path(sys.prefix)
    if (prefix / "pipx_metadata.json").exists():
        return Installer.PIPX
    if (prefix / "uv-receipt.toml").exists():
        return Installer.UV_TOOL
    if prefix.parent.name.startswith("archive-v") and find_spec("pip") is None:  # in the cache of uv
        return Installer.UVX
    return Installer.PIP if find_spec("pip") else Installer.UV_PIP


def _pip(installer: Installer) -> str:
    python = shlex.quote(sys.executable)
    return f"{python} -m pip install" if installer is Installer.PIP else f"uv pip install --python {python}"


def _origin() -> InstallSource | None:
    """Source of this copy; None if it is not there any more."""
    try:
        installed = distribution(NAME)
    except PackageNotFoundError:
        return InstallSource(str(PACKAGE.parent), is_editable=True)
    direct_url = installed.read_text("direct_url.json")
    if direct_url is None:
        return InstallSource(NAME) if _is_this_copy(installed) else InstallSource(str(PACKAGE.parent), is_editable=True)
    stated = json.loads(direct_url)
    is_editable = bool(stated.get("dir_info", {}).get("editable"))
    if is_editable or not _is_this_copy(installed):  # or a clone on PYTHONPATH
        return InstallSource(str(PACKAGE.parent), is_editable=True)
    return _origin_at(stated["url"], stated.get("vcs_info", {}))


def _origin_at(url: str, vcs: dict[str, str]) -> InstallSource | None:
    if vcs:
        return InstallSource(f"{vcs['vcs']}+{url}@{vcs['commit_id']}")
    if not url.startswith("file:"):
        return InstallSource(url)
    path = url2pathname(urlsplit(url).path)
    return InstallSource(path) if Path(path).exists() else None


def _is_this_copy(installed: Distribution) -> bool:
    return Path(str(installed.locate_file(NAME))).resolve() == PACKAGE.resolve()


def _present_extras(new_extra: str) -> list[str]:
    """Other extras whose packages are all installed."""
    extras = distribution(NAME).metadata.get_all("Provides-Extra") or []
    present = [extra for extra in extras if extra != new_extra and extra not in DEVELOPMENT]
    return [extra for extra in present if all(map(_is_installed, _packages_of(extra)))]


def _is_installed(requirement: str) -> bool:
    try:
        distribution(re.split(r"[^\w.-]", requirement, maxsplit=1)[0])
    except PackageNotFoundError:
        return False
    return True


def _packages_of(extra: str) -> list[str]:
    """Requirements of an extra as the metadata of this copy states them."""
    marked = re.compile(rf"""(.*?)\s*;.*\bextra\s*==\s*['"]{extra}['"]""")
    matches = (marked.fullmatch(requirement) for requirement in distribution(NAME).requires or ())
    return [match[1] for match in matches if match]
