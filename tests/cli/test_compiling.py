"""Progress of an analysis while it compiles the filters."""

from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest
from turntable_sessions import write_turntables

from gyrodrift.io.progress import COMPILING
from gyrodrift.library.analyses import compare, tune

pytest.importorskip("numba", reason="comparing needs the workstation extra")

pytestmark = pytest.mark.xdist_group("restlevel_kernel")  # its compilation takes seconds


@pytest.mark.promise("Analyses and reports")
@pytest.mark.parametrize(
    ("analysis", "first"),
    [(compare, "sessions"), (partial(tune, filter="hdr", iterations=8), "seed 0")],
    ids=["compare", "tune"],
)
def test_compiling_is_said_before_the_first_evaluation(
    analysis: Callable[..., object], first: str, tmp_path: Path
) -> None:
    """A first run says that it compiles, before its first evaluation."""
    stages: list[str] = []
    write_turntables(tmp_path, 2, minutes=0.4)
    analysis(tmp_path, on_progress=lambda stage, _done, _total: stages.append(stage))
    assert stages.count(COMPILING) == 1
    assert stages.index(COMPILING) < stages.index(first)
