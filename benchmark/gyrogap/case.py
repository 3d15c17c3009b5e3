"""A case of the benchmark: its label, its files, and held-out sessions of the same device."""

from dataclasses import asdict, dataclass, replace
from hashlib import blake2b
from pathlib import Path
from typing import Any

from gyrogap.physics.dice import Path as DicePath
from gyrogap.physics.dice import plan_dice
from gyrogap.physics.driven import Mover
from gyrogap.physics.kinds import InjectedEffect
from gyrogap.physics.stand import Stand, draw_plans
from gyrogap.physics.write import SessionBatch

NAME = "gyrogap"
VERSION = 2
"""Version of the benchmark; another one has other data for the same seed."""

DRAWN_AS = f"{NAME} {VERSION}"
"""Beginning of the paths of random numbers: a seed of an earlier version makes other cases."""

HELD_OUT_SESSIONS = 2
HELD_OUT_MINUTES = (1.5, 1.6)


@dataclass(frozen=True, slots=True)
class BenchmarkCase:
    """A case, decided.

    effects
        The injected effects.
    size
        small, typical or large; empty for pairs and cases without an effect.
    about
        A short description for a list of misses.
    mover
        What moves the device; None for a table with a motor.
    stated
        Effects that the simulator has at a wrong size.
    modeled
        Effects of the device that the simulator has at the right size: no gap.
    """

    seed: int
    row: str
    number: int
    stand: Stand
    effects: tuple[InjectedEffect, ...] = ()
    size: str = ""
    about: str = ""
    mover: Mover | None = None
    stated: tuple[InjectedEffect, ...] = ()
    modeled: tuple[InjectedEffect, ...] = ()

    @property
    def path(self) -> DicePath:
        """Path of the random numbers of the case."""
        return (DRAWN_AS, self.seed, self.row, self.number)

    @property
    def name(self) -> str:
        """Public name: letters that tell nothing to someone who does not know the seed."""
        return self._digest("name", 6)

    @property
    def salt(self) -> str:
        """Salt of the seal."""
        return self._digest("salt", 16)

    @property
    def axes(self) -> int:
        """Number of axes of the gyro, 1 or 3."""
        return 3 if self.stand.device.three_axes else 1

    def label(self) -> dict[str, Any]:
        """Everything that is sealed."""
        return {
            "case": self.name,
            "seed": self.seed,
            "row": self.row,
            "number": self.number,
            "axes": self.axes,
            "size": self.size,
            "effects": [asdict(effect) for effect in self.effects],
            "modeled": [asdict(effect) for effect in self.modeled],
            "about": self.about,
            "moved_by": self.mover or "table",
            **self.stand.label,
        }

    def write(self, folder: Path) -> None:
        """Write `simulator.yaml` and `sessions/`; the same case gives the same bytes."""
        folder.mkdir(parents=True)
        (folder / "simulator.yaml").write_text(self.stand.rig_text)
        self.recorded().write(folder / "sessions")

    def recorded(self) -> SessionBatch:
        """The sessions of the case."""
        return replace(self.stand.batch((*self.effects, *self.modeled), self.path), mover=self.mover)

    def held_out(self, effects: tuple[InjectedEffect, ...], noise: str) -> SessionBatch:
        """New sessions of the device with these effects and the modeled ones; effects and noise change no motion."""
        path = (*self.path, "held out")
        plans = draw_plans(plan_dice((*path, "plan")), HELD_OUT_MINUTES, HELD_OUT_SESSIONS)
        return replace(
            self.stand.batch((*effects, *self._modeled_with(effects)), path), plans=plans, mover=self.mover, noise=noise
        )

    def _modeled_with(self, effects: tuple[InjectedEffect, ...]) -> tuple[InjectedEffect, ...]:
        """Modeled effects that none of the effects replaces, as an answer with another size of one does."""
        names = {effect.name for effect in effects}
        return tuple(effect for effect in self.modeled if effect.name not in names)

    def _digest(self, purpose: str, size: int) -> str:
        return blake2b("/".join(map(str, (*self.path, purpose))).encode(), digest_size=size).hexdigest()
