"""Who may know whom: the rules that keep the rooms apart."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
MODULES = sorted([*(ROOT / "gyrodrift").rglob("*.py"), *(ROOT / "firmware_sim").rglob("*.py")])

LOWEST = ("gyrodrift.filters.hdr", "gyrodrift.sample", "gyrodrift.errors", "gyrodrift.config.yaml")
SHARED = {"gyrodrift.html": ("gyrodrift.html",), "gyrodrift.cluster": ("gyrodrift.cluster", "gyrodrift.errors")}
"""What all analyses of sessions may use, and nobody else, with the little of ours that it may use itself."""
ANALYSES = ("gyrodrift.evaluation", "gyrodrift.tune", "gyrodrift.diagnose", "gyrodrift.compare")
MAY_USE_THE_SIMULATOR = (
    "gyrodrift.cli.diagnose",
    "gyrodrift.simulation.hard_cases",
    "gyrodrift.simulation.hard_motions",
    "gyrodrift.simulation.replay",
    "gyrodrift.cli.replay",
    "gyrodrift.simulation.sessions",
    "gyrodrift.cli.simulate",
    "gyrodrift.simulation.published_set",
)


def name_of(path: Path) -> str:
    return ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")


def imports_of(path: Path) -> set[str]:
    found = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: imports are absolute"
            found |= {node.module or ""} | {f"{node.module}.{alias.name}" for alias in node.names}
    return found


def of(package: str, names: set[str]) -> set[str]:
    return {name for name in names if name == package or name.startswith(f"{package}.")}


@pytest.mark.parametrize("path", MODULES, ids=name_of)
def test_arrows_point_down(path: Path) -> None:
    """Low rooms do not know high ones, device and host do not know each other, and nothing imports the commands."""
    name, imports = name_of(path), imports_of(path)
    if name.startswith("firmware_sim"):
        assert not of("gyrodrift", imports)
    elif name not in MAY_USE_THE_SIMULATOR and not name.startswith("gyrodrift.diagnose"):
        assert not of("firmware_sim", imports)
    if name in LOWEST:
        assert not of("gyrodrift", imports)
    if not name.startswith("gyrodrift.cli") and name != "gyrodrift.__main__":
        assert not of("gyrodrift.cli", imports)
    for low in ("gyrodrift.link", "gyrodrift.session"):
        if name.startswith(low):
            assert (
                not of("gyrodrift.service", imports)
                | of("gyrodrift.demo", imports)
                | of("gyrodrift.config.model", imports)
            )


@pytest.mark.parametrize("path", MODULES, ids=name_of)
def test_what_analyses_share_knows_none_of_them(path: Path) -> None:
    """Neither the page that a report stands on nor the cluster asks whose work it does."""
    name, imports = name_of(path), imports_of(path)
    for shared, known in SHARED.items():
        if of(shared, {name}):
            assert of("gyrodrift", imports) == set().union(*(of(room, imports) for room in known))
        elif of(shared, imports):
            assert any(of(analysis, {name}) for analysis in ANALYSES)


@pytest.mark.parametrize("path", MODULES, ids=name_of)
def test_only_one_room_knows_pyserial(path: Path) -> None:
    """The port."""
    assert not of("serial", imports_of(path)) or name_of(path) == "gyrodrift.link.port"


@pytest.mark.parametrize("path", MODULES, ids=name_of)
def test_a_file_opens_with_what_it_is(path: Path) -> None:
    """The first line of a module is its docstring."""
    assert ast.get_docstring(ast.parse(path.read_text()))


SERVE = "import gyrodrift.cli.serve, gyrodrift.service.loop, gyrodrift.config.watch, gyrodrift.log, gyrodrift.link.link"


@pytest.mark.parametrize("statement", ["import gyrodrift.cli", SERVE])
def test_the_service_stays_light(statement: str) -> None:
    """Neither the command line nor the service with all it may load brings numerical or plotting packages."""
    code = f"import sys; {statement}; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    heavy = {"numpy", "scipy", "matplotlib", "pandas", "numba", "firmware_sim"}
    assert not heavy & set(done.stdout.split())
