"""Recordings of real sensors: what every method makes of them, as it was worked out elsewhere."""

import pytest
from recordings_support import Recordings

pytest.importorskip("numba", reason="comparing needs the workstation extra")
from gyrodrift.compare.methods.registry import by_key
from gyrodrift.evaluation.dataset import Source, load_with_reference
from gyrodrift.evaluation.score import score_of

pytestmark = pytest.mark.xdist_group("restlevel_kernel")  # its compilation takes seconds

BY_KEY = by_key()

E_DEG = {
    "broad_01": {"euler": 48.6, "start": 1.77, "xio": 7.47, "vqf": 2.64, "hdr": 48.2, "restlevel": 1.82},
    "broad_06": {"euler": 46.3, "start": 3.57, "xio": 3.89, "vqf": 3.05, "hdr": 45.7, "restlevel": 2.93},
    "broad_14": {"euler": 22.8, "start": 0.21, "xio": 3.46, "vqf": 1.25, "hdr": 22.4, "restlevel": 0.88},
    "mpu6050_still": {"euler": 368.0, "start": 2.38, "xio": 12.1, "vqf": 1.84, "hdr": 368.0, "restlevel": 0.01},
    "temperature_sweep": {"euler": 2090.0, "start": 699.0, "xio": 10.8, "vqf": 2.02, "hdr": 2090.0, "restlevel": 0.088},
}
"""Mean |yaw error|, deg, with defaults and the trapezoidal rule; restlevel from an independent second program."""


@pytest.mark.parametrize("name", E_DEG)
@pytest.mark.parametrize("key", ["euler", "start", "xio", "vqf", "hdr", "restlevel"])
def test_mean_error_of_every_method(name: str, key: str, recordings: Recordings) -> None:
    """Equal to the table within its digits."""
    if not BY_KEY[key].is_installed:
        pytest.skip(f"{BY_KEY[key].title} needs the package {BY_KEY[key].package}")
    loaded = load_with_reference(Source(recordings.path(name)))
    yaw_deg = BY_KEY[key].run(loaded.t_s, loaded.reference.rate_dps, BY_KEY[key].defaults)
    assert score_of(loaded.reference, yaw_deg).e_deg == pytest.approx(E_DEG[name][key], rel=0.02, abs=0.006)
