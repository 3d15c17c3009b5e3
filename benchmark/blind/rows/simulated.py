"""Cases from `gyrodrift simulate`: the rig is the simulator's own, so that there is no gap by construction.

The command line is all that is used of it. The rig that it writes beside the sessions is not handed on.
"""

import subprocess
import sys
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

from gyrogap.catalogue import EFFECTS
from gyrogap.physics.dice import Path as DicePath
from gyrogap.physics.dice import Rng
from gyrogap.physics.kinds import InjectedEffect
from gyrogap.physics.rig_text import rig_text
from gyrogap.physics.spread import DeviceFacts, draw_facts, draw_fault_for, log_uniform
from gyrogap.physics.stand import describe

from blind.rows.case import Draft

ROOT = Path(__file__).resolve().parent.parent.parent.parent
PROFILES = ("identify", "turntable", "drive")
LIVELY = ("turntable", "drive")
"""What moves within its first ten seconds; `identify` is still for a minute."""

SHORT = 0.25
MOST_SAMPLES = 200_000
"""Of all sessions together: fast devices get shorter ones, so that a case takes a minute and not five."""


@dataclass(frozen=True, slots=True)
class Simulated:
    """Sessions of equal length from one rig."""

    rig: str
    profile: str
    sessions: int
    minutes: float
    seed: int

    def write(self, folder: Path) -> None:
        """Simulate; the folder holds the sessions and nothing else."""
        with TemporaryDirectory(prefix="blind-rig-") as temporary:
            rig = Path(temporary) / "rig.yaml"
            rig.write_text(self.rig)
            words = ["--rig", str(rig), "--profile", self.profile, "--seed", str(self.seed), "--format", "csv"]
            words += ["--sessions", str(self.sessions), "--minutes", str(self.minutes), "--out", str(folder)]
            subprocess.run(
                [sys.executable, "-m", "gyrodrift", "simulate", *words], cwd=ROOT, check=True, stderr=subprocess.DEVNULL
            )
        (folder / "rig.yaml").unlink()


def no_gap(rng: Rng, number: int, path: DicePath) -> Draft:
    """Three to six sessions of one to six minutes, some of less than one; none, one or two effects in the rig."""
    facts = draw_facts(rng)
    sessions = int(rng.integers(3, 7))
    profile, minutes = str(rng.choice(PROFILES)), log_uniform(rng, 1.0, 6.0)
    if rng.random() < SHORT:
        profile, minutes = str(rng.choice(LIVELY)), rng.uniform(25.0, 50.0) / 60.0
    minutes = min(minutes, max(1.0, MOST_SAMPLES / (sessions * 60.0 * facts.sample_hz)))
    return _draft(rng, facts, profile, sessions, minutes)


def short_no_gap(rng: Rng, number: int, path: DicePath) -> Draft:
    """Three sessions of forty seconds, at 50 or 100 Hz: as little as there can be."""
    facts = draw_facts(rng)
    return _draft(rng, replace(facts, sample_hz=min(facts.sample_hz, 100)), str(rng.choice(LIVELY)), 3, 40.0 / 60.0)


def _draft(rng: Rng, facts: DeviceFacts, profile: str, sessions: int, minutes: float) -> Draft:
    count = int(rng.choice([0, 1, 2], p=[0.4, 0.4, 0.2]))
    names = rng.choice(EFFECTS, count, replace=False).tolist()
    effects = tuple(draw_fault_for(rng, facts, name, str(rng.choice(["small", "typical"]))) for name in names)
    rig = own_rig(rng, facts, effects)
    return Draft(
        kind="none",
        rig=rig,
        parts={"sessions": Simulated(rig, profile, sessions, round(minutes, 3), draw_seed(rng))},
        about=f"{profile}, {sessions} × {minutes:.2g} min, {describe(facts)}, has {' and '.join(names) or 'no effect'}",
        facts={"facts": asdict(facts)},
    )


def own_rig(rng: Rng, facts: DeviceFacts, effects: tuple[InjectedEffect, ...]) -> str:
    """A rig file that states all there is."""
    base = {
        "sample_rate_hz": facts.sample_hz,
        "dps_per_lsb": facts.dps_per_lsb,
        "noise_dps_rthz": facts.noise_dps_rthz,
        "bias_dps": round(rng.uniform(-0.6, 0.6), 3),
        "encoder_cpr": facts.encoder_cpr,
        "encoder_absolute": facts.encoder_absolute,
        "encoder_phase_deg": round(rng.uniform(0.0, 360.0), 3),
        "host_delay_s": round(rng.uniform(0.001, 0.008), 4),
        "host_jitter_s": facts.host_jitter_s,
    }
    return rig_text(base, effects)


def draw_seed(rng: Rng) -> int:
    """For `simulate`."""
    return int(rng.integers(1_000_000_000))
