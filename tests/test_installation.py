"""The command that a message gives is right for the way in which this copy is installed."""

import json
import sys
from email.message import Message
from importlib.metadata import PackageNotFoundError
from pathlib import Path
from typing import Any

import pytest

from gyrodrift.io import installation
from gyrodrift.io.installation import PACKAGE, extra_command, package_command

WHEEL: dict[str, Any] = {"archive_info": {}}
EDITABLE = {"dir_info": {"editable": True}}
PRESENT = ("rich", "websockets")
REQUIRES = ['cma<5,>=4.0; extra == "lab"', 'rich>=13.7; python_version > "3"', 'scipy<2,>=1.11; extra == "lab"']


class Metadata:
    """Metadata of an installed distribution."""

    def __init__(self, direct_url: dict[str, Any] | None, folder: Path = PACKAGE.parent) -> None:
        self.requires = [*REQUIRES, 'websockets>=14; extra == "websocket"']
        self.metadata = Message()
        for extra in ("lab", "websocket"):
            self.metadata["Provides-Extra"] = extra
        self._direct_url, self._folder = direct_url, folder

    def read_text(self, name: str) -> str | None:
        assert name == "direct_url.json"
        return None if self._direct_url is None else json.dumps(self._direct_url)

    def locate_file(self, name: str) -> Path:
        return self._folder / name


@pytest.fixture
def install(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Any:
    """Pretend that gyrodrift is installed in some way."""

    def pretend(metadata: Metadata, prefix: str = "venv", *, mark: str = "", has_pip: bool = True) -> None:

        def find(name: str) -> Metadata:
            if name not in ("gyrodrift", *PRESENT):
                raise PackageNotFoundError(name)
            return metadata

        folder = tmp_path / prefix
        folder.mkdir(parents=True)
        if mark:
            (folder / mark).touch()
        monkeypatch.setattr(sys, "prefix", str(folder))
        monkeypatch.setattr(sys, "executable", "/venv/bin/python")
        monkeypatch.setattr(installation, "distribution", find)
        monkeypatch.setattr(installation, "find_spec", lambda _: "pip" if has_pip else None)

    return pretend


@pytest.fixture
def wheel(tmp_path: Path) -> Path:
    path = tmp_path / "gyrodrift-1-py3-none-any.whl"
    path.touch()
    return path


def test_a_clone_is_installed_again_as_editable(install: Any) -> None:
    install(Metadata({"url": PACKAGE.parent.as_uri(), **EDITABLE}))
    assert extra_command("lab") == f"/venv/bin/python -m pip install --editable '{PACKAGE.parent}[lab]'"


def test_a_clone_on_the_path_wins_over_an_installed_copy(install: Any, tmp_path: Path) -> None:
    """The command adds the packages to the copy that runs."""
    install(Metadata(None, tmp_path))
    assert extra_command("lab") == f"/venv/bin/python -m pip install --editable '{PACKAGE.parent}[lab]'"


def test_a_wheel_is_named_by_its_path(install: Any, wheel: Path) -> None:
    install(Metadata({"url": wheel.as_uri(), **WHEEL}))
    assert extra_command("lab") == f"/venv/bin/python -m pip install '{wheel}[lab]'"


@pytest.mark.promise("Installation and systems")
def test_without_the_wheel_its_packages_are_named(install: Any, wheel: Path) -> None:
    """A message about a missing package names the package source of this copy, not a name in an index."""
    install(Metadata({"url": wheel.as_uri(), **WHEEL}))
    wheel.unlink()
    assert extra_command("lab") == "/venv/bin/python -m pip install 'cma<5,>=4.0' 'scipy<2,>=1.11'"


def test_only_a_copy_from_an_index_is_installed_by_its_name(install: Any) -> None:
    install(Metadata(None))
    assert extra_command("lab") == "/venv/bin/python -m pip install 'gyrodrift[lab]'"


def test_a_copy_from_git_names_its_commit(install: Any) -> None:
    install(Metadata({"url": "https://host/gyrodrift.git", "vcs_info": {"vcs": "git", "commit_id": "abc"}}))
    command = extra_command("lab")
    assert command == "/venv/bin/python -m pip install 'gyrodrift[lab] @ git+https://host/gyrodrift.git@abc'"


def test_an_environment_of_uv_has_no_pip(install: Any, wheel: Path) -> None:
    install(Metadata({"url": wheel.as_uri(), **WHEEL}), has_pip=False)
    assert extra_command("lab") == f"uv pip install --python /venv/bin/python '{wheel}[lab]'"


def test_pipx_installs_again_with_the_extra(install: Any, wheel: Path) -> None:
    install(Metadata({"url": wheel.as_uri(), **WHEEL}), "venvs/gyrodrift", mark="pipx_metadata.json", has_pip=False)
    assert extra_command("lab") == f"pipx install --force '{wheel}[lab,websocket]'"
    assert package_command("vqf") == "pipx inject gyrodrift vqf"


def test_a_tool_of_uv_is_installed_again_with_the_extra(install: Any, wheel: Path) -> None:
    install(Metadata({"url": wheel.as_uri(), **WHEEL}), mark="uv-receipt.toml", has_pip=False)
    assert extra_command("lab") == f"uv tool install --force '{wheel}[lab,websocket]'"


def test_uvx_runs_again_with_the_extra(install: Any, wheel: Path) -> None:
    install(Metadata({"url": wheel.as_uri(), **WHEEL}), "archive-v0/x", has_pip=False)
    assert extra_command("lab") == f"uvx --from '{wheel}[lab,websocket]' gyrodrift"
    assert package_command("vqf") == f"uvx --from {wheel} --with vqf gyrodrift"
