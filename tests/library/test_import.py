"""`import gyrodrift` costs nothing, and its names are what they are called, whatever was imported before."""

import subprocess
import sys

import pytest

import gyrodrift

HEAVY = {"numpy", "pydantic", "serial", "scipy", "numba", "matplotlib", "firmware_sim"}


def loaded_by(code: str) -> set[str]:
    done = subprocess.run(
        [sys.executable, "-c", f"{code}; import sys; print(*sys.modules)"], capture_output=True, text=True, check=True
    )
    return set(done.stdout.split())


def test_the_package_alone_loads_nothing_of_itself() -> None:
    loaded = loaded_by("import gyrodrift")
    assert {name for name in loaded if name.startswith("gyrodrift")} == {"gyrodrift"}
    assert not loaded & HEAVY


def test_names_load_only_what_is_called() -> None:
    names = "Hdr, Restlevel, load_session, open_link, tune, diagnose, compare"
    assert not loaded_by(f"from gyrodrift import {names}") & HEAVY


@pytest.mark.parametrize("before", ["pass", "import gyrodrift.tune.result, gyrodrift.compare.comparison"])
def test_analyses_stay_callable(before: str) -> None:
    code = (
        f"{before}\nfrom gyrodrift import tune, compare\nfrom gyrodrift.values.errors import DataError\n"
        "import gyrodrift\n"
        "for call in (tune, gyrodrift.tune, compare, gyrodrift.compare, gyrodrift.tune):\n"
        "    try: call('missing')\n"
        "    except DataError as error: print(error)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines() == ["missing: there is no such session or folder"] * 5


def test_a_name_that_is_none_is_refused_as_usual() -> None:
    with pytest.raises(AttributeError, match="has no attribute 'Hdx'"):
        getattr(gyrodrift, "Hdx")  # noqa: B009 - the checker would see it
    assert set(gyrodrift.__all__) <= set(dir(gyrodrift))
