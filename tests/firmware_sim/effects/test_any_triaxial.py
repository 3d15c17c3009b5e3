"""Any rig with three axes: finite numbers, ranges kept, and the same measurements in blocks of any size."""

from itertools import islice
from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from firmware_sim.effects.triaxial.catalogue import TRIAXIAL
from firmware_sim.effects.triaxial.effect import TriaxialEffect
from firmware_sim.measure import ACCEL_MISSING, COUNTS_MAX, TriaxialBlock, joined, measure
from firmware_sim.motion.profile import load_motion, shipped_profiles
from firmware_sim.rig import Base, Rig, ThreeAxes, parse_effect
from firmware_sim.wire.registry import ENCODERS

SAMPLES = 192


def any_of(kind: type[TriaxialEffect]) -> st.SearchStrategy[TriaxialEffect]:
    """Effects with any parameters within their limits."""
    values: dict[str, st.SearchStrategy[Any]] = {}
    for name, field in kind.model_fields.items():
        if name == "name":
            continue
        marks = {type(mark).__name__: mark for mark in field.metadata}
        low = marks["Ge"].ge if "Ge" in marks else 1e-3
        values[name] = st.floats(float(low), float(marks["Le"].le))
    return st.builds(kind, **values)


axes = st.builds(
    ThreeAxes,
    gyro_bias_x_dps=st.floats(-50.0, 50.0),
    gyro_bias_y_dps=st.floats(-50.0, 50.0),
    mps2_per_lsb=st.one_of(st.just(0.0), st.floats(1e-4, 0.1)),
    accel_noise_mps2_rthz=st.floats(0.0, 0.1),
    gravity_mps2=st.floats(0.0, 30.0),
    effects=st.lists(st.one_of([any_of(kind) for kind in TRIAXIAL.values()]), max_size=5).map(tuple),
)
scalar = st.sampled_from(["bandwidth", "stale_hold", "latency", "bias_instability", "quantization", "sample_drop"])
rigs = st.builds(
    lambda block, names: Rig(base=Base(three_axes=block), effects=tuple(parse_effect(name) for name in names)),
    axes,
    st.lists(scalar, max_size=2),
)
profiles = st.sampled_from(shipped_profiles())


def played(rig: Rig, profile: str, size: int) -> TriaxialBlock:
    blocks = islice(measure(rig, load_motion(profile), 3, block_samples=size), -(-SAMPLES // size))
    whole, *rest = blocks
    for block in rest:
        whole = joined(whole, block)
    assert isinstance(whole, TriaxialBlock)
    return whole


@given(rigs, profiles, st.sampled_from([32, 64, 96]))
def test_blocks_of_any_size_hold_the_same_measurements(rig: Rig, profile: str, size: int) -> None:
    small, large = played(rig, profile, size), played(rig, profile, SAMPLES)
    for column in ("rate_raw", "gyro_xy_raw", "accel_raw", "is_clipped", "accel_clipped", "t_device_us"):
        assert np.array_equal(getattr(small, column), getattr(large, column)), column
    assert np.abs(large.gyro_xy_raw.astype(np.int64)).max(initial=0) <= COUNTS_MAX
    assert large.accel_raw.min(initial=0) >= ACCEL_MISSING


@given(rigs, profiles)
def test_every_protocol_plays_any_rig(rig: Rig, profile: str) -> None:
    """A frame per measurement; a BNO08x greets with one more."""
    block = played(rig, profile, SAMPLES)
    for encoder in ENCODERS.values():
        assert sum(frame.rows for frame in encoder.frames([block], rig.base)) == len(block.seq)
