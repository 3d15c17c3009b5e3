"""Tests share a worker if their files name the same `xdist_group` in `pytestmark`, or have fixtures for all tests.

pytest-xdist 3.8 writes the group to an attribute of a test that pytest 9.2 no longer reads, and so spreads a group
over all workers: a group's fixtures are made, and its kernels compiled, once in each of them.
"""

import re
from functools import cache
from pathlib import Path

from xdist.scheduler import LoadGroupScheduling

ROOT = Path(__file__).parent.parent
GROUP = re.compile(r'^pytestmark = .*xdist_group\("(\w+)"\)', re.MULTILINE)


def group_of(nodeid: str) -> str:
    """The name of the group of a test, its file if tests share a fixture there, or the test's own id."""
    file = nodeid.split("::", 1)[0]
    return _group_in(ROOT / file) or (file if _shares_fixtures(ROOT / file) else nodeid)


@cache
def _group_in(path: Path) -> str:
    named = GROUP.search(path.read_text()) if path.is_file() else None
    return named[1] if named else ""


@cache
def _shares_fixtures(path: Path) -> bool:
    """Whether a file has fixtures of its own for all its tests."""
    return path.is_file() and 'scope="module"' in path.read_text()


class GroupScheduling(LoadGroupScheduling):  # type: ignore[misc]  # xdist ships no type information
    """A group goes to one worker as a whole, and every other test on its own."""

    def _split_scope(self, nodeid: str) -> str:
        return group_of(nodeid)
