"""Imports between packages, circles of files, and the first line of each file."""

import ast
import re
import subprocess
import sys
from collections import defaultdict
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
BENCHMARK = ROOT / "benchmark"
PROGRAMS_OF_BOARDS = ROOT / "gyrodrift" / "firmware" / "files"
MODULES = sorted(
    path
    for folder in (ROOT / "gyrodrift", ROOT / "firmware_sim", BENCHMARK / "gyrogap")
    for path in folder.rglob("*.py")
    if not path.is_relative_to(PROGRAMS_OF_BOARDS)
)

PACKAGES = ("gyrodrift", "firmware_sim", "gyrogap")

BASE = "effects errors io sample values"
"""Packages that know each other and no other package; `errors` and `sample` are public names of `values`."""

ROOMS = {
    "filters": BASE,
    "session": f"{BASE} columns",
    "facts": f"{BASE} columns session",
    "session.checks": f"{BASE} columns facts session",
    "columns": BASE,
    "link": f"{BASE} columns session",
    "report": BASE,
    "outputs": BASE,
    "config": f"{BASE} columns filters firmware_sim.plain_value firmware_sim.strict_yaml link outputs",
    "describe": f"{BASE} evaluation facts filters report session session.checks",
    "doctor": f"{BASE} columns describe evaluation facts filters link outputs session session.checks",
    "recording": f"{BASE} filters link session",
    "calibrate": f"{BASE} facts link",
    "service": f"{BASE} calibrate columns config filters firmware_sim.strict_yaml link outputs recording",
    "top": f"{BASE} outputs service",
    "evaluation": f"{BASE} facts filters session session.checks",
    "simulation": f"{BASE} firmware_sim session",
    "tune": f"{BASE} evaluation filters report session session.checks",
    "compare": f"{BASE} evaluation filters report session session.checks tune",
    "diagnose.recording": f"{BASE} evaluation facts session session.checks",
    "diagnose.features": f"{BASE} diagnose.recording",
    "diagnose.simulate": f"{BASE} diagnose.features diagnose.recording firmware_sim session session.checks simulation",
    "diagnose.inference": f"{BASE} diagnose.features diagnose.recording diagnose.simulate firmware_sim",
    "diagnose.predictive_checks": f"{BASE} diagnose.features diagnose.inference diagnose.recording diagnose.simulate "
    "evaluation filters firmware_sim session session.checks tune",
    "diagnose": f"{BASE} diagnose.features diagnose.inference "
    "diagnose.predictive_checks diagnose.recording diagnose.simulate firmware_sim session session.checks simulation",
    "diagnose.report": f"{BASE} diagnose diagnose.export diagnose.features diagnose.inference "
    "diagnose.predictive_checks report",
    "diagnose.export": f"{BASE} diagnose diagnose.inference diagnose.report firmware_sim report",
    "demo": f"{BASE} filters",
    "firmware": f"{BASE} filters config",
    "library": f"{BASE} columns compare config diagnose diagnose.report evaluation filters firmware_sim report link "
    "session session.checks simulation tune",
    "firmware_sim": "firmware_sim.plain_value firmware_sim.strict_yaml",
    "firmware_sim.strict_yaml": "firmware_sim.plain_value",
    "firmware_sim.plain_value": "",
    "gyrogap": "cli io values",
}
"""Each package with the packages it may import: data goes from the first to the last, and no value travels back."""


def name_of(path: Path) -> str:
    folder = BENCHMARK if path.is_relative_to(BENCHMARK) else ROOT
    return ".".join(path.relative_to(folder).with_suffix("").parts).removesuffix(".__init__")


NAMES = {name_of(path): path for path in MODULES}


@cache
def imports_of(path: Path) -> frozenset[str]:
    """Modules that a file imports, ours by their own names; names taken out of a module stand for the module."""
    result = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            result |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: imports are absolute"
            inside = {f"{node.module}.{alias.name}" for alias in node.names}
            result |= (inside & NAMES.keys()) or {node.module or ""}
    return frozenset(result)


def of(package: str, names: frozenset[str] | set[str]) -> set[str]:
    return {name for name in names if name == package or name.startswith(f"{package}.")}


def room_of(name: str) -> str:
    """`diagnose.features` for a part with a row of its own, else the package or the single file below gyrodrift."""
    package, *inside = name.split(".")
    if name in ROOMS:  # the one file of the simulated device that the host shares
        return name
    if package != "gyrodrift":
        return package
    if ".".join(inside[:2]) in ROOMS:
        return ".".join(inside[:2])
    return inside[0] if inside else "gyrodrift"


def forbidden_rooms(path: Path) -> set[str]:
    """Rooms that a file imports from, and that ROOMS does not allow its room."""
    space = room_of(name_of(path))
    if space in {"cli", "__main__", "gyrodrift"}:
        return set()
    imports = imports_of(path)
    expected = {room_of(name) for package in PACKAGES for name in of(package, imports)}
    allowed = set((BASE if space in BASE.split() else ROOMS[space]).split())
    return expected - allowed - {space, "gyrodrift"}


def test_arrows_are_as_drawn() -> None:
    """A room knows those that ROOMS allows it; the commands know all, and nothing knows the commands."""
    assert {name_of(path): packages for path in MODULES if (packages := forbidden_rooms(path))} == {}


def test_no_circle_of_files() -> None:
    arrows = {name: {second for second in imports_of(path) if second in NAMES} for name, path in NAMES.items()}
    done: set[str] = set()

    def visit(name: str, way: tuple[str, ...]) -> None:
        assert name not in way, " → ".join((*way[way.index(name) :], name))
        if name not in done:
            for second in sorted(arrows[name]):
                visit(second, (*way, name))
            done.add(name)

    for name in arrows:
        visit(name, ())


def test_a_class_name_has_one_meaning() -> None:
    places = defaultdict(list)
    for path in MODULES:
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                places[node.name].append(name_of(path))
    assert not {name: where for name, where in places.items() if len(where) > 1}


PLAYS = ("firmware_sim.measure", "gyrodrift.simulation", "gyrodrift.session.files", "gyrodrift.diagnose.diagnosis")
KNOWLEDGE = {
    f"gyrodrift.diagnose.simulate.{name}"
    for name in ("candidate", "candidate_kind", "candidates", "kinds", "response_table")
}
"""Knowledge of effects and tables of simulations; the other files of that package play the rig."""


def simulation_in(path: Path) -> set[str]:
    imports = imports_of(path)
    return set().union(*(of(module, imports) for module in PLAYS)) | (
        of("gyrodrift.diagnose.simulate", imports) - KNOWLEDGE
    )


def test_what_judges_or_draws_does_not_simulate() -> None:
    """Inference and report of a diagnosis work on values: whoever loads sessions and plays the rig hands them in."""
    judges = [path for path in MODULES if room_of(name_of(path)) in {"diagnose.inference", "diagnose.report"}]
    assert {name_of(path): names for path in judges if (names := simulation_in(path))} == {}


@pytest.mark.parametrize(("package", "file"), [("serial", "gyrodrift.link.port"), ("structlog", "gyrodrift.io.logger")])
def test_only_one_file_imports_a_package(package: str, file: str) -> None:
    """The port knows pyserial; the logger keeps structlog light."""
    assert {name_of(path) for path in MODULES if of(package, imports_of(path))} == {file}


def test_a_file_opens_with_what_it_is() -> None:
    """The first line of a module is its docstring."""
    assert [name_of(path) for path in MODULES if not ast.get_docstring(ast.parse(path.read_text()))] == []


SERVE = (
    "import gyrodrift.cli.serve, gyrodrift.service.loop, gyrodrift.config.watch, gyrodrift.io.log, gyrodrift.link.link"
)


@pytest.mark.parametrize("statement", ["import gyrodrift.cli", SERVE])
def test_the_service_stays_light(statement: str) -> None:
    code = f"import sys; {statement}; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    heavy = {"numpy", "scipy", "matplotlib", "jinja2", "pandas", "numba", "rich", "twisted"}
    loaded = set(done.stdout.split())
    assert not heavy & loaded
    assert not {"gyrodrift.columns.fields", "gyrodrift.columns.shape", "gyrodrift.link.text_decoder"} & loaded
    assert of("firmware_sim", loaded) <= {"firmware_sim", "firmware_sim.plain_value", "firmware_sim.strict_yaml"}


def test_outputs_of_the_command_line_take_no_parser_of_configs() -> None:
    """With the live page the service and its outputs stay below 40 MB."""
    code = "import sys; from gyrodrift.config.outputs import output_of; output_of('web:port=0'); print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not {"pydantic", "yaml", "importlib.metadata"} & set(done.stdout.split())


SOURCE = re.compile(
    r"Chosen|Measured|Derived|Cited|[Dd]ata sheet|as in |as above|IEEE|RFC|"
    r"\b(19|20)\d\d\b|[Bb]y definition|public interface"
)
"""Words of a docstring that say where a number comes from."""


def numbers_without_source(path: Path) -> list[str]:
    """Constants of a file that are numbers, and whose docstring does not say where they come from."""
    body, unsaid = ast.parse(path.read_text()).body, []
    for i, node in enumerate(body):
        targets = node.targets if isinstance(node, ast.Assign) else []
        names = [item.id for target in targets for item in ast.walk(target) if isinstance(item, ast.Name)]
        values = list(ast.walk(node.value)) if isinstance(node, ast.Assign) else []
        is_number = any(isinstance(v, ast.Constant) and type(v.value) in (int, float) for v in values)
        if not (is_number and names and all(name.isupper() for name in names)):
            continue
        if any(isinstance(value, ast.Call | ast.JoinedStr) for value in values):
            continue
        following = (later for later in body[i + 1 :] if not isinstance(later, ast.Assign | ast.AnnAssign))
        said = next(following, None)
        is_text = isinstance(said, ast.Expr) and isinstance(said.value, ast.Constant)
        if not (is_text and SOURCE.search(str(said.value.value))):  # type: ignore[union-attr]
            unsaid.append(f"{name_of(path)}: {', '.join(names)}")
    return unsaid


@pytest.mark.parametrize("package", ["filters", "diagnose"])
def test_each_number_has_a_source(package: str) -> None:
    """Cited, derived, measured, or chosen for a reason."""
    paths = [path for path in MODULES if path.is_relative_to(ROOT / "gyrodrift" / package)]
    assert [line for path in paths for line in numbers_without_source(path)] == []
