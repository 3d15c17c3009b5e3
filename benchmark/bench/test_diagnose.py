"""How long a diagnosis takes, and how that grows with sessions, their length and the candidates."""

import time
from pathlib import Path

import pytest

from bench.harness import show
from firmware_sim.effects.catalogue import CATALOGUE
from firmware_sim.motion.profile import load_profile
from firmware_sim.rig import load_rig, parse_effect, with_effects
from gyrodrift.cli import main
from gyrodrift.simulation.sessions import write_sessions

pytestmark = pytest.mark.timeout(1200)

HALF = tuple(word for name in sorted(CATALOGUE)[::2] if name != "scale_factor" for word in ("--withhold", name))


def diagnosed_s(folder: Path, sessions: int, minutes: float, *options: str) -> float:
    """Time of the whole command on two cores, sessions of the shipped rig with an effect at 100 Hz."""
    recorded = folder / f"{sessions}-{minutes:g}"
    if not recorded.exists():
        rig = with_effects(load_rig(None), [parse_effect("scale_factor:error_percent=1.2")])
        list(write_sessions(rig, load_profile("identify"), recorded, 5, sessions, minutes))
        (recorded / "rig.yaml").unlink()
    start_s = time.perf_counter()
    assert main(["diagnose", str(recorded), "--out", str(folder / "report"), "--jobs", "2", *options]) == 0
    return time.perf_counter() - start_s


def test_time_grows_with_sessions_length_and_candidates(tmp_path: Path) -> None:
    """Six sessions of eight minutes, then half of each."""
    whole_s = diagnosed_s(tmp_path, 6, 8.0)
    rows = [("six sessions of eight minutes, all candidates", f"{whole_s:.1f} s")]
    for name, seconds in (
        ("three sessions", diagnosed_s(tmp_path, 3, 8.0)),
        ("four minutes", diagnosed_s(tmp_path, 6, 4.0)),
        (f"{len(CATALOGUE) - len(HALF) // 2} of {len(CATALOGUE)} effects", diagnosed_s(tmp_path, 6, 8.0, *HALF)),
    ):
        rows.append((f"  with {name}", f"{seconds:.1f} s, {seconds / whole_s:.2f} of that"))
    show("A diagnosis, two processes", rows)
