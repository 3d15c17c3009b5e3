"""Every fault of the mutation run still applies, and the run tells a caught fault from one that is not."""

from pathlib import Path

import pytest
from mutate.copy import ROOT, Outcome, try_fault
from mutate.fault import Fault, FaultError
from mutate.faults import FAULTS

AREAS = {
    "axes",
    "device-yaw",
    "calibrate",
    "link",
    "session",
    "sources",
    "recording",
    "service",
    "outputs",
    "config",
    "filters",
    "diagnose",
    "firmware",
    "firmware_sim",
}


def test_faults_have_names_of_their_own_and_cover_all_areas() -> None:
    assert len(FAULTS) >= 60
    assert len({fault.name for fault in FAULTS}) == len(FAULTS)
    assert {fault.area for fault in FAULTS} == AREAS


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.name)
def test_a_fault_applies_and_its_tests_exist(fault: Fault) -> None:
    fault.check(ROOT)
    changed = fault.applied_to((ROOT / fault.file).read_text())
    assert fault.old != fault.new
    compile(changed, fault.file, "exec")


def test_a_text_that_is_gone_or_occurs_twice_is_told() -> None:
    fault = Fault("link/gone", "a.py", "x = 1", "x = 2", "Nothing.", ())
    for source in ("y = 1\n", "x = 1\nx = 1\n"):
        with pytest.raises(FaultError, match=r"fault link/gone does not apply any more: .* in a\.py"):
            fault.applied_to(source)


@pytest.mark.parametrize(
    ("test", "outcome"),
    [
        ("assert double(2) == 4", Outcome.CAUGHT),
        ("assert double(0) == 0", Outcome.NOT_CAUGHT),
        ("import nothing_of_that_name", Outcome.CAUGHT),
    ],
)
def test_a_fault_is_caught_where_a_test_fails(tmp_path: Path, test: str, outcome: Outcome) -> None:
    source, tests = tmp_path / "double.py", tmp_path / "test_double.py"
    source.write_text("def double(x):\n    return 2 * x\n")
    tests.write_text(f"from double import double\ndef test_double():\n    {test}\n")
    fault = Fault("link/double", "double.py", "2 * x", "3 * x", "Doubles are triples.", ("test_double.py",))
    assert try_fault(tmp_path, fault, 0).outcome is outcome
    assert source.read_text() == "def double(x):\n    return 2 * x\n"


def test_tests_that_cannot_run_catch_nothing(tmp_path: Path) -> None:
    """A fault counts as caught only where a test has failed."""
    (tmp_path / "double.py").write_text("x = 2\n")
    fault = Fault("link/double", "double.py", "2", "3", "Doubles are triples.", ("test_none.py",))
    assert try_fault(tmp_path, fault, 0).outcome is Outcome.ERROR
