"""Plain Python and its compiled twin: records within records are laid out and changed alike."""

import subprocess
import sys
from dataclasses import asdict, dataclass, field
from pathlib import Path
from types import FunctionType
from typing import cast

import pytest

from gyrodrift.evaluation.kernels.restlevel import array_of, compiled, layout
from gyrodrift.io.compile import stamp_of


@dataclass(slots=True)
class Inner:
    height: float = 1.0
    is_new: bool = True


@dataclass(slots=True)
class Entry:
    weight: float = 0.0
    inner: Inner = field(default_factory=Inner)


@dataclass(slots=True)
class Outer:
    count: int = 7
    inner: Inner = field(default_factory=Inner)
    entries: list[Entry] = field(default_factory=lambda: [Entry(), Entry(2.0), Entry()])


def raised(inner: Inner, by: float) -> float:
    """Changes a record within a record."""
    inner.height += by
    inner.is_new = False
    return inner.height


def changed(outer: Outer, by: float) -> float:
    """Changes what is nested in it, by itself and by a function that it calls."""
    total = raised(outer.inner, by)
    for entry in outer.entries:
        if entry.weight > 1.0:
            total += raised(entry.inner, 10.0 * by)
        entry.weight += 1.0
    outer.count += 1
    return total


def test_a_layout_has_the_fields_of_the_record() -> None:
    """A nested record is a structured type; a list has as many entries as in a new record."""
    made = layout(Outer)
    assert made.names == ("count", "inner", "entries")
    assert made["inner"] == layout(Inner)
    assert made["entries"].subdtype == (layout(Entry), (3,))


def test_a_compiled_function_changes_nested_records_as_the_plain_one_does() -> None:
    plain = Outer()
    made = array_of(plain)
    assert compiled(cast(FunctionType, changed))(made[0], 0.1) == changed(plain, 0.1)
    assert made.tobytes() == array_of(plain).tobytes()
    assert asdict(plain.entries[1]) == {"weight": 3.0, "inner": {"height": 2.0, "is_new": False}}


def test_compiled_code_is_kept_for_the_next_run() -> None:
    run = (
        "import numpy as np\n"
        "from gyrodrift.evaluation.kernels import restlevel\n"
        "restlevel.walk(np.full(3, 0.01), np.zeros(3), restlevel.RestlevelParams())\n"
        "print(len(restlevel._follow.stats.cache_hits), len(restlevel._follow.stats.cache_misses))"
    )
    output = [subprocess.run([sys.executable, "-c", run], capture_output=True, text=True, check=True) for _ in range(3)]
    assert output[-1].stdout == "1 0\n"


def test_the_stamp_of_a_package_depends_on_all_its_sources(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    inner = tmp_path / "stamped" / "inner"
    inner.mkdir(parents=True)
    (tmp_path / "stamped" / "__init__.py").touch()
    (inner / "some.py").write_text("A = 1\n")
    monkeypatch.syspath_prepend(tmp_path)
    before = stamp_of("stamped")
    assert stamp_of("stamped") == before
    (inner / "some.py").write_text("A = 2\n")
    assert stamp_of("stamped") != before
