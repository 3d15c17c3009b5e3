"""A small part of the fuzzing, in every run: what is kept of earlier ones, and a few inputs made by chance."""

from collections.abc import Iterator
from pathlib import Path
from random import Random

import pytest
from fuzz.command import CORPUS, NAMES
from fuzz.limits import Limited
from fuzz.mutate import mutated
from fuzz.targets import FOLDER, TARGETS, forget
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

KEPT = sorted(path for path in CORPUS.glob("*/*") if path.is_file())
SEEDS = {name: [path.read_bytes() for path in KEPT if path.parent.name == name] for name in NAMES}


def assert_target_holds(name: str, content: bytes) -> None:
    """A target raises nothing but what it expects, and asserts the rest itself."""
    TARGETS[name](content)


@pytest.fixture(scope="module", autouse=True)
def files() -> Iterator[None]:
    FOLDER.mkdir(exist_ok=True)
    yield
    forget()


def test_every_target_is_run_and_has_what_to_begin_with() -> None:
    assert set(NAMES) == set(TARGETS) == set(SEEDS)
    assert all(SEEDS.values())


@pytest.mark.parametrize("path", KEPT, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_what_is_kept_breaks_nothing(path: Path) -> None:
    assert_target_holds(path.parent.name, path.read_bytes())


@pytest.mark.parametrize("name", NAMES)
@settings(suppress_health_check=[HealthCheck.too_slow])
@given(seed=st.integers(0, 1 << 32), content=st.one_of(st.none(), st.binary(max_size=400)))
def test_what_chance_makes_breaks_nothing(name: str, seed: int, content: bytes | None) -> None:
    assert_target_holds(name, mutated(name, SEEDS[name], Random(seed)) if content is None else content)


def test_an_input_that_takes_much_memory_breaks_its_target(monkeypatch: pytest.MonkeyPatch) -> None:
    """The peak of the process rises by 400 MB in the first call, and by 600 MB in the second."""
    peaks_mb = iter([300, 700, 700, 1300])
    monkeypatch.setattr("fuzz.limits._peak_bytes", lambda: next(peaks_mb) << 20)
    target = Limited(lambda _: None, 10.0)
    target(b"small")
    with pytest.raises(AssertionError, match="5 bytes took 600 MB"):
        target(b"large")
