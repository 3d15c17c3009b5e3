"""Kill every writer at random moments, as often as asked, and look at what is left."""

import argparse
import subprocess
import time
from collections.abc import Callable
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory

from support import ours

from crash.kills import killed_diagnose, killed_serve, killed_tune, killed_writer

RIG = Path(__file__).resolve().parent.parent.parent / "config" / "rig.yaml"


def main() -> int:
    """All of them, with a seed that is told."""
    parser = argparse.ArgumentParser(prog="python -m benchmark crash", description=__doc__)
    parser.add_argument("--kills", type=int, default=20, help="of each writer (default 20)")
    parser.add_argument("--seed", type=int, default=0, help="0 draws one (default 0)")
    asked = parser.parse_args()
    seed = asked.seed or int(time.time())
    random = Random(seed)
    with TemporaryDirectory(prefix="gyrodrift-crash-") as name:
        folder = Path(name)
        sessions = folder / "sessions-in"
        made = ours("simulate", "--out", sessions, "--sessions", "4", "--minutes", "1", "--seed", "1", "--quiet")
        subprocess.run(made, check=True)
        kills: dict[str, tuple[float, Callable[[float], object]]] = {
            "a config, written again and again": (0.3, lambda at_s: killed_writer(folder, at_s)),
            "serve --record": (3.0, lambda at_s: killed_serve(folder, at_s)),
            "tune, then --resume": (12.0, lambda at_s: killed_tune(sessions, folder, at_s)),
            "diagnose": (40.0, lambda at_s: killed_diagnose(sessions, RIG, folder, at_s)),
        }
        print(f"seed {seed}", flush=True)
        for what, (longest_s, kill) in kills.items():
            for _ in range(asked.kills):
                kill(random.uniform(0.0, longest_s))
            print(f"{what}: {asked.kills} kills, nothing half and nothing lost", flush=True)
    return 0
