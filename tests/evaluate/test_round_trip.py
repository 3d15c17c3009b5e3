"""Effects through `gyrodrift simulate` and `gyrodrift diagnose`: short sessions at a low rate, one process."""

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest
from evaluate.round_trip_part import names_first_or_tied

from firmware_sim.effects.catalogue import CATALOGUE
from firmware_sim.rig import load_rig
from gyrodrift.cli import main
from gyrodrift.simulation.sessions import rig_yaml

pytest.importorskip("matplotlib", reason="pictures need the workstation extra")

pytestmark = pytest.mark.usefixtures("diagnosis_kernels")

SAMPLE_RATE_HZ = 50.0
SIZE = ("--sessions", "2", "--minutes", "0.8", "--seed", "3")
SLOW = ("popcorn", "bias_instability", "rate_random_walk", "stale_hold", "sample_drop", "usb_batching", "encoder_slip")
"""Effects of a simulation by chance that take most of the time, and that resemble none of those below."""

MOTION = """\
about: Of a test. Rest, turns both ways at several speeds, swings.
segments:
  - {kind: rest, seconds: 8}
  - {kind: steps, rates_dps: [30, -30, 90, -90], ramp_seconds: 2, hold_seconds: 4}
  - {kind: chirp, seconds: 10, amplitude_dps: 40, from_hz: 0.2, to_hz: 1.0}
  - {kind: rest, seconds: 8}
"""


@pytest.fixture(scope="module")
def rig(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The shipped rig at a low sample rate."""
    shipped = load_rig(None)
    path = tmp_path_factory.mktemp("rig") / "rig.yaml"
    base = shipped.base.model_copy(update={"sample_rate_hz": SAMPLE_RATE_HZ})
    path.write_text(rig_yaml(shipped.model_copy(update={"base": base})))
    return path


def all_but(*kept: str) -> frozenset[str]:
    """Effects that a diagnosis of a few does not try."""
    return frozenset(CATALOGUE) - set(kept)


def diagnosed(folder: Path, rig: Path, *effects: str, axes: int = 1, withheld: Iterable[str] = SLOW) -> dict[str, Any]:
    """`gap.json` of simulated sessions with some effects; the rig of the diagnosis has one axis."""
    motion, sessions, report = folder / "motion.yaml", folder / "sessions", folder / "report"
    motion.write_text(MOTION)
    common = ["--rig", str(rig), "--quiet"]
    made = ["--out", str(sessions), "--profile", str(motion), "--axes", str(axes), *SIZE, *common]
    assert main(["simulate", *made, *(word for effect in effects for word in ("--effect", effect))]) == 0
    tried = [word for name in withheld for word in ("--withhold", name)]
    assert main(["diagnose", str(sessions), "--out", str(report), "--jobs", "1", *tried, *common]) == 0
    gap: dict[str, Any] = json.loads((report / "gap.json").read_text())
    return gap


@pytest.mark.evaluation
@pytest.mark.parametrize(
    ("effect", "parameter", "size"),
    [
        ("clock_drift:ppm=2000", "ppm", 2000.0),
        ("spikes:height_dps=50,share_percent=0.1", "share_percent", 0.1),
        ("latency:delay_ms=20", "delay_ms", 20.0),
        ("scale_factor:error_percent=1.5", "error_percent", 1.5),
        ("backlash:play_deg=0.5", "play_deg", 0.5),
        ("timestamp_jitter:sigma_ms=1", "sigma_ms", 1.0),
    ],
)
def test_a_simulated_effect_is_named_with_its_size(
    tmp_path: Path, rig: Path, effect: str, parameter: str, size: float
) -> None:
    gap = diagnosed(tmp_path, rig, effect)
    assert gap["verdict"] in {"effect", "partly"}
    assert names_first_or_tied(gap, effect.partition(":")[0])
    sizes = gap["causes"][0]["parameters"][parameter]
    assert 0.95 * sizes["low"] < size < 1.05 * sizes["high"]


def sizes_of(gap: dict[str, Any]) -> dict[str, float]:
    """Size of each cause."""
    return {cause["effect"]: next(iter(cause["parameters"].values()))["value"] for cause in gap["causes"]}


TILTED, LOW, HIGH = (
    "misalignment:tilt_deg=12,about_deg=70",
    "scale_factor:error_percent=-2",
    "scale_factor:error_percent=3",
)
CHIP = ("gyro_cross_axis", "accel_bias", "accel_misalignment")
"""Errors of a chip with three axes at their typical sizes."""

OTHERS = all_but("misalignment", "scale_factor")
"""Effects that resemble none of these; they are tried as well in the cases of `make evaluate`."""


@pytest.mark.parametrize(
    ("effects", "sizes", "withheld"),
    [
        ((TILTED, HIGH), {"misalignment": 12.0, "scale_factor": 3.0}, OTHERS),
        *(
            pytest.param(effects, sizes, SLOW, marks=pytest.mark.evaluation)
            for effects, sizes in (
                ((TILTED, HIGH), {"misalignment": 12.0, "scale_factor": 3.0}),
                (CHIP, {}),
                ((), {}),
                ((TILTED,), {"misalignment": 12.0}),
                ((LOW,), {"scale_factor": -2.0}),
                ((TILTED, *CHIP), {"misalignment": 12.0}),
            )
        ),
    ],
)
def test_three_axes_tell_a_tilted_sensor_from_a_scale_error(
    tmp_path: Path, rig: Path, effects: tuple[str, ...], sizes: dict[str, float], withheld: Iterable[str]
) -> None:
    """Alone, both at once, and beside the errors of a chip; nothing is tied."""
    gap = diagnosed(tmp_path, rig, *effects, axes=3, withheld=withheld)
    assert sizes_of(gap) == pytest.approx(sizes, rel=0.15)
    assert not any(cause["tied_with"] for cause in gap["causes"])
    assert gap["verdict"] == ("effect" if sizes else "none")


@pytest.mark.parametrize(
    ("effect", "withheld"),
    [(TILTED, OTHERS), *(pytest.param(effect, SLOW, marks=pytest.mark.evaluation) for effect in (TILTED, LOW))],
)
def test_one_axis_leaves_a_tilted_sensor_tied_with_a_scale_error(
    tmp_path: Path, rig: Path, effect: str, withheld: Iterable[str]
) -> None:
    """The scale error first by its prior; three axes are what to record next."""
    gap = diagnosed(tmp_path, rig, effect, withheld=withheld)
    (cause,) = gap["causes"]
    assert (cause["effect"], cause["tied_with"]) == ("scale_factor", ["misalignment"])
    assert gap["next"].startswith("Record with three axes")
