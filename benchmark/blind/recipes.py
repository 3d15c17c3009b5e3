"""Which cases a set has, and all that is decided about each before anything is generated."""

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from hashlib import blake2b
from pathlib import Path as FolderPath
from typing import Any, Literal

from gyrogap.catalogue import EFFECTS, STAGE
from gyrogap.physics.bench import Columns
from gyrogap.physics.device import Device, RigFile, draw_device
from gyrogap.physics.dice import Path, Rng, plan_dice
from gyrogap.physics.kinds import InjectedEffect
from gyrogap.physics.outside_sizes import OUTSIDE, OUTSIDE_SIZES, draw_outside
from gyrogap.physics.pairs import PAIRS, EffectPair
from gyrogap.physics.sessions import SessionPlan, plan_sessions
from gyrogap.physics.sizes import SIZES, Ranges, draw_fault
from gyrogap.physics.write import SessionBatch

Kind = Literal["single", "none", "outside", "pair", "left_out"]

NO_GAP = 40
DECOYS = 8
"""So many of the cases without a gap have something withheld in a second run, as those have that leave one out."""

SEEDS = {"smoke": 3, "development": 1, "final": 20260}
DEVELOPMENT: Ranges = ((0.9, 1.0), (1.1, 1.2))
FINAL: Ranges = ((0.8, 0.9), (1.0, 1.1))
PART = {"smoke": DEVELOPMENT, "development": DEVELOPMENT, "final": FINAL}
"""Ranges from which a set draws what it varies a size by; those of the final one are lower."""

SHAPE = {"smoke": (3, (1.2, 1.5)), "development": (0, (6.0, 8.0)), "final": (4, (6.0, 7.0))}
"""Sessions, and minutes of each; where it says 0 sessions, the seed takes four to six."""

SMOKE: tuple[tuple[Kind, str, str], ...] = (
    ("single", "latency", "large"),
    ("single", "clock_drift", "large"),
    ("none", "", ""),
    ("outside", "motor_bias", "large"),
    ("outside", "host_wander", "large"),
    ("pair", "15", ""),  # scale_factor and sample_drop
    ("left_out", "scale_factor", "typical"),
)
"""One of each kind that a wrong turn of the diagnosis would show in; the case left out is tried with its effect too."""


@dataclass(frozen=True, slots=True)
class Recipe:
    """A case, decided.

    name
        Random letters; the order of names tells nothing of the order of cases.
    faults
        What is put in.
    stages
        Which stage of the rig would be a right answer.
    withhold
        What a second run must do without; empty where there is no second run.
    """

    set_name: str
    seed: int
    index: int
    kind: Kind
    size: str
    faults: tuple[InjectedEffect, ...]
    stages: tuple[str, ...]
    about: str
    withhold: str
    device: Device
    rig: RigFile
    sessions: tuple[SessionPlan, ...]

    @property
    def path(self) -> Path:
        """Where its random numbers are found."""
        return (self.set_name, self.seed, self.index)

    @property
    def name(self) -> str:
        """Of the case, in public."""
        return blake2b("/".join(map(str, (*self.path, "name"))).encode(), digest_size=6).hexdigest()

    @property
    def title(self) -> str:
        """Of the case, among those who know: `single/latency/typical`."""
        return "/".join([self.kind, "+".join(fault.name for fault in self.faults) or "nothing", self.size]).strip("/")

    def label(self) -> dict[str, Any]:
        """All that is sealed."""
        return {
            "case": self.name,
            "set": self.set_name,
            "seed": self.seed,
            "index": self.index,
            "kind": self.kind,
            "size": self.size,
            "effects": [asdict(fault) for fault in self.faults],
            "stages": list(self.stages),
            "about": self.about,
            "withhold": self.withhold,
            "device": self.device.facts(),
            "sessions": [plan.facts() for plan in self.sessions],
        }


def write_case(recipe: Recipe, folder: FolderPath) -> None:
    """Generate and write; the same recipe gives the same bytes."""
    batch_of(recipe).write(folder / "sessions")
    (folder / "rig.yaml").write_text(recipe.rig.text(recipe.device))


def session_columns(recipe: Recipe, number: int) -> Columns:
    """Measurements of one session."""
    return batch_of(recipe).columns(number)


def batch_of(recipe: Recipe) -> SessionBatch:
    """The sessions of a recipe."""
    return SessionBatch(recipe.device, recipe.sessions, recipe.faults, recipe.path)


@dataclass(frozen=True, slots=True)
class _Entry:
    kind: Kind
    name: str
    size: str


def recipes(set_name: str, seed: int) -> list[Recipe]:
    """All cases of a set."""
    return [_recipe(set_name, seed, index, entry) for index, entry in enumerate(_entries(set_name))]


def _entries(set_name: str) -> Iterator[_Entry]:
    if set_name == "smoke":
        yield from (_Entry(*entry) for entry in SMOKE)
        return
    yield from (_Entry("single", effect, size) for effect in EFFECTS for size in SIZES)
    yield from (_Entry("none", "decoy" if number < DECOYS else "", "") for number in range(NO_GAP))
    yield from (_Entry("outside", name, size) for name in OUTSIDE for size in OUTSIDE_SIZES)
    yield from (_Entry("pair", str(number), "") for number in range(len(PAIRS)))
    yield from (_Entry("left_out", effect, "typical") for effect in EFFECTS)


def _recipe(set_name: str, seed: int, index: int, entry: _Entry) -> Recipe:
    rng = plan_dice((set_name, seed, index, "plan"))
    faults, stages, about = _content(rng, entry, PART[set_name])
    withhold = entry.name if entry.kind == "left_out" else ""
    if entry.name == "decoy":
        withhold = str(rng.choice(EFFECTS))
    few, minutes = SHAPE[set_name]
    sessions = plan_sessions(rng, few or int(rng.integers(4, 7)), minutes)
    device, rig = draw_device(rng, len(sessions), usual_rate=entry.size == "small")
    return Recipe(
        set_name=set_name,
        seed=seed,
        index=index,
        kind=entry.kind,
        size=entry.size,
        faults=faults,
        stages=stages,
        about=about,
        withhold=withhold,
        device=device,
        rig=rig,
        sessions=tuple(sessions),
    )


def _content(rng: Rng, entry: _Entry, part: Ranges) -> tuple[tuple[InjectedEffect, ...], tuple[str, ...], str]:
    if entry.kind == "none":
        return (), (), "nothing but another bias, noise, sample rate and host delay"
    if entry.kind == "outside":
        outside = OUTSIDE[entry.name]
        return (draw_outside(rng, entry.name, entry.size, part),), outside.stages, outside.about
    if entry.kind == "pair":
        pair = PAIRS[int(entry.name)]
        faults = tuple(_pair_faults(rng, pair, part))
    else:
        faults = (draw_fault(rng, entry.name, entry.size, part),)
    return faults, tuple(STAGE[fault.name] for fault in faults), " and ".join(fault.name for fault in faults)


def _pair_faults(rng: Rng, pair: EffectPair, part: Ranges) -> Iterator[InjectedEffect]:
    for name, size, way in zip((pair.first, pair.second), pair.sizes, pair.ways, strict=True):
        yield draw_fault(rng, name, size, part, way)
