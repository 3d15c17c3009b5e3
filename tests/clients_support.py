"""Real clients that tests run as processes: programs of `tests/clients`, under Python or node."""

import json
import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest
from outputs_support import csv_at_100_hz
from support import PATIENCE_S, Command, never

CLIENTS = Path(__file__).parent / "clients"


def python_client(package: str, script: str, *args: str) -> "subprocess.Popen[str]":
    """A program that needs a package of PyPI."""
    if find_spec(package) is None:
        pytest.skip(f"{package} is not installed: pip install {package}")
    return _started(sys.executable, script, *args)


def node_client(package: str, script: str, *args: str) -> "subprocess.Popen[str]":
    """A program that needs a package of npm."""
    return _started(need_node(CLIENTS, package), script, *args)


def need_node(folder: Path, package: str) -> str:
    """Node itself, where a package of npm is in a folder."""
    node = shutil.which("node")
    if node is None:
        pytest.skip("node is not installed")
    if not (folder / "node_modules" / package).is_dir():
        pytest.skip(f"npm's {package} is not installed: npm ci --prefix {folder.relative_to(CLIENTS.parents[1])}")
    return node


def fed(client: "subprocess.Popen[str]", serve: Command, device: Any) -> dict[str, Any]:
    sent = 0

    def has_ended(_: Command) -> bool:
        nonlocal sent
        device.send_all(csv_at_100_hz(5, first=sent), never)
        sent += 5
        try:
            client.wait(0.05)  # that is as long as five samples take
        except subprocess.TimeoutExpired:
            return False
        return True

    try:
        serve.until(has_ended, "end of the client")
    finally:
        client.kill()
        statement, complaint = client.communicate(timeout=PATIENCE_S)
    assert client.returncode == 0, (statement, complaint)
    return dict(json.loads(statement.splitlines()[-1]))


def _started(program: str, script: str, *args: str) -> "subprocess.Popen[str]":
    return subprocess.Popen(
        [program, str(CLIENTS / script), *args],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
