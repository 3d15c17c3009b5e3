"""Tests of one group run in one worker."""

import re

from worker_groups import GROUP, ROOT, group_of


def test_a_group_is_that_of_the_file_or_a_file_with_shared_fixtures_and_other_tests_are_on_their_own() -> None:
    assert group_of("tests/test_wheel.py::test_it[a::b@c]") == "wheel"
    assert group_of("tests/test_files.py::test_it[x]") == "tests/test_files.py::test_it[x]"
    assert group_of("tests/crash/test_crash.py::test_it") == "tests/crash/test_crash.py"
    assert group_of("tests/cli/test_diagnose.py::test_it") == "diagnosis"


def test_every_group_is_named_where_it_is_looked_for() -> None:
    used = re.compile(r"^(?:pytestmark = |@).*xdist_group\(", re.MULTILINE)
    files = [path.read_text() for path in (ROOT / "tests").rglob("test_*.py")]
    assert [len(GROUP.findall(text)) for text in files] == [len(used.findall(text)) for text in files]
