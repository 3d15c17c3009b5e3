"""Cost of other values of the constants of restlevel: each of them 1.5 times as large and as small, or its odds.

The motions are the everyday ones. CRPS is that of a normal distribution with the stated sigma, deg. A constant with
hardly any effect could go; one with a large effect has to be right.
"""

import ast
import importlib
import pkgutil
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType

import numpy as np

from evaluate.everyday_motions import MOTIONS, Session, session
from evaluate.figures import Figure, mean_figure
from gyrodrift.evaluation.score import normal_crps
from gyrodrift.filters import restlevel
from gyrodrift.filters.restlevel.model import RestlevelParams, RestlevelState
from gyrodrift.filters.restlevel.step import coefficients, step
from gyrodrift.values.arrays import Floats

FACTOR = 1.5
EVERY_S = 1.0
"""Time between two scores of a session, s."""


def measure(seed: int, count: int, folder: Path, say: Callable[[str], None]) -> list[Figure]:
    """Relative change of the mean CRPS by each constant, the larger of both values, most important first."""
    del folder
    sessions = [
        session(motion, n, is_still=still, seed=seed)
        for motion in MOTIONS
        for still in (True, False)
        for n in range(count)
    ]
    today = _scores(sessions)
    say(f"today: CRPS {today.mean():.4g} deg over {len(sessions)} sessions")
    figures = []
    for name, module in constants():
        changes = [_changed(sessions, today, name, module, factor) for factor in (FACTOR, 1.0 / FACTOR)]
        worst = max(changes, key=lambda change: abs(np.nan_to_num(change.mean())))
        say(f"{name}: {', '.join(f'{100.0 * change.mean():+.2f} %' for change in changes)}")
        figures.append(
            mean_figure(f"{module.__name__.rpartition('.')[2]}.{name}: change of CRPS in %", (100.0 * worst).tolist())
        )
    return sorted(figures, key=lambda figure: -abs(figure.value))


def constants() -> Iterator[tuple[str, ModuleType]]:
    """Float constants of restlevel with their modules."""
    for info in pkgutil.iter_modules(restlevel.__path__, f"{restlevel.__name__}."):
        module = importlib.import_module(info.name)
        for node in ast.parse(Path(str(module.__file__)).read_text()).body:
            targets = node.targets if isinstance(node, ast.Assign) else []
            for name in (item.id for target in targets for item in ast.walk(target) if isinstance(item, ast.Name)):
                if name.isupper() and isinstance(getattr(module, name), float):
                    yield name, module


def _changed(sessions: list[Session], today: Floats, name: str, module: ModuleType, factor: float) -> Floats:
    """Change of each session's CRPS as a share of the mean today."""
    old = getattr(module, name)
    value = old * factor if not 0.0 < old < 1.0 else factor / (factor + 1.0 / old - 1.0)  # odds of a probability
    with _constant(name, module, value):
        try:
            return np.asarray((_scores(sessions) - today) / today.mean())
        except (OverflowError, ZeroDivisionError):  # a limit that keeps numbers finite
            return np.full(len(today), np.nan)


@contextmanager
def _constant(name: str, module: ModuleType, value: float) -> Iterator[None]:
    """Another value in the module and in those that import the name."""
    old = getattr(module, name)
    places = [
        place
        for key, place in sys.modules.items()
        if key.startswith("gyrodrift.filters") and getattr(place, name, None) is old
    ]
    for place in places:
        setattr(place, name, value)
    try:
        yield
    finally:
        for place in places:
            setattr(place, name, old)


def _scores(sessions: list[Session]) -> Floats:
    return np.array([_crps(ride) for ride in sessions])


def _crps(ride: Session) -> float:
    """Mean CRPS of yaw, deg."""
    c, s, errors_deg, sigmas_deg, due_s = coefficients(RestlevelParams()), RestlevelState(), [], [], 0.0
    for t_s, rate_dps, yaw_deg in zip(ride.t_s.tolist(), ride.rate_dps.tolist(), ride.yaw_deg.tolist(), strict=True):
        step(c, s, t_s, rate_dps)
        if t_s >= due_s:
            due_s += EVERY_S
            errors_deg.append(s.yaw_deg - yaw_deg)
            sigmas_deg.append(s.yaw_sigma_deg)
    return float(normal_crps(np.array(errors_deg), np.array(sigmas_deg)).mean())
