"""Plain Python and its compiled twin: records within records are laid out and changed alike."""

import subprocess
import sys
from dataclasses import asdict, dataclass, field
from pathlib import Path
from types import FunctionType
from typing import cast

import pytest

from gyrodrift.compile import stamp_of
from gyrodrift.evaluation.kernels.compiled import array_of, compiled, layout


@dataclass(slots=True)
class Inner:
    height: float = 1.0
    is_new: bool = True


@dataclass(slots=True)
class Place:
    weight: float = 0.0
    inner: Inner = field(default_factory=Inner)


@dataclass(slots=True)
class Outer:
    count: int = 7
    inner: Inner = field(default_factory=Inner)
    places: list[Place] = field(default_factory=lambda: [Place(), Place(2.0), Place()])


def raised(inner: Inner, by: float) -> float:
    """Changes a record within a record."""
    inner.height += by
    inner.is_new = False
    return inner.height


def changed(outer: Outer, by: float) -> float:
    """Changes what is nested in it, by itself and by a function that it calls."""
    found = raised(outer.inner, by)
    for place in outer.places:
        if place.weight > 1.0:
            found += raised(place.inner, 10.0 * by)
        place.weight += 1.0
    outer.count += 1
    return found


def test_a_layout_has_the_fields_of_the_record() -> None:
    """A record within is a structured type; a list has as many places as a new record."""
    made = layout(Outer)
    assert made.names == ("count", "inner", "places")
    assert made["inner"] == layout(Inner)
    assert made["places"].subdtype == (layout(Place), (3,))


def test_a_compiled_function_changes_nested_records_as_the_plain_one_does() -> None:
    """And gives back the same."""
    plain = Outer()
    made = array_of(plain)
    assert compiled(cast(FunctionType, changed))(made[0], 0.1) == changed(plain, 0.1)
    assert made.tobytes() == array_of(plain).tobytes()
    assert asdict(plain.places[1]) == {"weight": 3.0, "inner": {"height": 2.0, "is_new": False}}


def test_what_was_compiled_is_kept_for_the_next_run() -> None:
    """And found by a process that has compiled nothing; two that compile at once may overwrite what the other kept."""
    run = (
        "import numpy as np\n"
        "from gyrodrift.evaluation.kernels import restlevel\n"
        "restlevel.walk(np.full(3, 0.01), np.zeros(3), restlevel.RestlevelParams())\n"
        "print(len(restlevel._follow.stats.cache_hits), len(restlevel._follow.stats.cache_misses))"
    )
    said = [subprocess.run([sys.executable, "-c", run], capture_output=True, text=True, check=True) for _ in range(3)]
    assert said[-1].stdout == "1 0\n"


def test_the_stamp_of_a_package_is_that_of_all_its_sources(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """However deep they lie."""
    inner = tmp_path / "stamped" / "inner"
    inner.mkdir(parents=True)
    (tmp_path / "stamped" / "__init__.py").touch()
    (inner / "some.py").write_text("A = 1\n")
    monkeypatch.syspath_prepend(tmp_path)
    before = stamp_of("stamped")
    assert stamp_of("stamped") == before
    (inner / "some.py").write_text("A = 2\n")
    assert stamp_of("stamped") != before
