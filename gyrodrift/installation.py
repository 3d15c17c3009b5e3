"""How this program is installed: where it runs from, and the command that adds a package to it."""

import platform
import shlex
import sys
from importlib import import_module
from importlib.metadata import PackageNotFoundError, distribution
from importlib.util import find_spec
from pathlib import Path

from gyrodrift import __version__
from gyrodrift.errors import UsageError

PACKAGE = Path(__file__).parent


def version_line() -> str:
    """Version, the folder that runs, and the Python that runs it."""
    return f"gyrodrift {__version__} from {PACKAGE} (Python {platform.python_version()}, {sys.executable})"


def extra_command(extra: str) -> str:
    """The command that installs what an extra needs, into this very environment.

    An installer takes `gyrodrift[extra]` for what is installed already, from a clone as well as from a wheel, and adds
    what the extra lacks.
    """
    try:
        distribution("gyrodrift")
    except PackageNotFoundError:  # a clone on PYTHONPATH
        return f"{_installer()} --editable {shlex.quote(f'{PACKAGE.parent}[{extra}]')}"
    return package_command(f"gyrodrift[{extra}]")


def package_command(requirement: str) -> str:
    """The command that installs a package into this very environment."""
    return f"{_installer()} {shlex.quote(requirement)}"


def need_packages(what: str, *names: str) -> None:
    """Refuse to begin where a package of the workstation is missing, rather than break off half way.

    Raises
    ------
    UsageError
        With the command that installs what `what` needs.
    """
    try:
        for name in names:
            import_module(name)
    except ImportError as error:
        raise UsageError(f"{what} needs the package {error.name}: {extra_command('lab')}") from error


def _installer() -> str:
    """Of the tool that made the environment: pipx and uv make some without pip."""
    prefix = Path(sys.prefix)
    if (prefix / "pipx_metadata.json").exists():
        return f"pipx runpip {shlex.quote(prefix.name)} install"
    python = shlex.quote(sys.executable)
    return f"{python} -m pip install" if find_spec("pip") else f"uv pip install --python {python}"
