"""The benches by name, with the package of each and how quickly it may be accelerated."""

from collections.abc import Callable
from dataclasses import dataclass
from importlib.util import find_spec

from simulators.flaws import Floats, Rng
from simulators.unseen import drake_benches, pymunk_benches


@dataclass(frozen=True, slots=True)
class Bench:
    """A simulation, the package that it needs, and the acceleration that it follows, deg/s²."""

    simulate: Callable[[Floats, float, Rng], tuple[Floats, Floats]]
    package: str
    most_dps2: float

    def is_installed(self) -> bool:
        """Whether the simulator is there."""
        return find_spec(self.package) is not None


BENCHES = {
    "Drake table": Bench(drake_benches.table, "pydrake", 1500.0),
    "Drake torso": Bench(drake_benches.torso, "pydrake", 400.0),
    "Drake gimbal": Bench(drake_benches.gimbal, "pydrake", 600.0),
    "pymunk rover": Bench(pymunk_benches.rover, "pymunk", 350.0),
    "pymunk shaft": Bench(pymunk_benches.shaft, "pymunk", 900.0),
}
