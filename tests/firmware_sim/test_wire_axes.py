"""A device with three axes in every protocol that carries them, as the host reads it."""

from itertools import islice

import numpy as np
import pytest

from firmware_sim.faults.catalogue import FAULTS, faulty_blocks, faulty_frames, parse_fault
from firmware_sim.measure import TriaxialBlock, measure
from firmware_sim.motion.profile import config_folder, load_motion, shipped_profiles
from firmware_sim.rig import Rig, load_rig, parse_effect, with_effects
from firmware_sim.wire.registry import ENCODERS
from gyrodrift.link.protocols.detect import Detector
from gyrodrift.link.protocols.registry import PROTOCOLS
from gyrodrift.link.protocols.text import text_protocol
from gyrodrift.values.sample import Reading

RIG = load_rig(config_folder() / "rig-three-axes.yaml")
COLUMNS = "t_ms=t_ms, gx=gx:lsb/131, gy=gy:lsb/131, gz=rate:lsb/131, ax=ax:lsb/16384, ay=ay:lsb/16384, az=az:lsb/16384"
STEPS = {
    "native": (1e-6, 1e-6),
    "csv": (1e-4, 1e-4),
    "witmotion": (0.031, 0.0025),
    "witmotion-ble": (0.031, 0.0025),
    "vectornav": (1e-4, 1e-4),
    "vectornav-ascii": (5e-5, 6e-4),
    "xsens": (1e-4, 1e-4),
    "text": (0.0039, 0.0004),
}
"""Half a step of rate, deg/s, and of acceleration, m/s², by protocol."""

ATTITUDES = [name for name in shipped_profiles() if (config_folder() / "profiles/attitude" / f"{name}.yaml").is_file()]


def block_of(rig: Rig, profile: str) -> TriaxialBlock:
    block = next(measure(rig, load_motion(profile), 0, block_samples=1500))
    assert isinstance(block, TriaxialBlock)
    return block


def read(protocol: str, block: TriaxialBlock) -> list[Reading]:
    decoder = (text_protocol(COLUMNS) if protocol == "text" else PROTOCOLS[protocol]).decoder()
    return [r for frame in ENCODERS[protocol].frames([block], RIG.base) for r in decoder.push(frame.content)]


@pytest.mark.parametrize("protocol", STEPS)
def test_a_protocol_carries_all_axes_of_the_device(protocol: str) -> None:
    block = block_of(RIG, "ramps")
    readings = read(protocol, block)
    sent = np.column_stack([block.gyro_xy_raw, block.rate_raw, block.accel_raw]).astype(np.float64)
    sent *= [0.0152588] * 3 + [0.0023942] * 3
    received = np.array([list(reading.inertial or [np.nan] * 6) for reading in readings])
    assert len(received) >= len(sent) - 1
    error = np.abs(received - sent[-len(received) :]).max(axis=0)
    step_dps, step_mps2 = STEPS[protocol]
    assert error[:3].max() <= step_dps
    assert error[3:].max() <= step_mps2
    assert np.ptp(sent, axis=0).min() > 0.4


@pytest.mark.parametrize("protocol", ["native", "csv"])
def test_a_missing_acceleration_is_missing_at_the_host(protocol: str) -> None:
    block = block_of(with_effects(RIG, [parse_effect("accel_dropout:from_s=5,to_s=8")]), "ramps")
    received = np.array([list(reading.inertial or [np.nan] * 6) for reading in read(protocol, block)])
    assert np.flatnonzero(np.isnan(received[:, 3])).tolist() == list(range(500, 800))
    assert np.isfinite(received[:, :3]).all()


@pytest.mark.parametrize("profile", ATTITUDES)
def test_csv_is_detected_on_any_motion(profile: str) -> None:
    whole = next(measure(RIG, load_motion(profile), 0, block_samples=3000))
    for first in (0, 1000, 2000):
        detector = Detector([protocol for protocol in PROTOCOLS.values() if protocol.is_detected])
        frames = ENCODERS["csv"].frames([whole.only(whole.seq >= first)], RIG.base)
        detected = next((sure for frame in frames if (sure := detector.push(frame.content))), None)
        assert detected is not None
        assert detected[0].name == "csv"


@pytest.mark.parametrize("fault", [name for name in FAULTS if name not in {"unplug", "wrong_baud"}])
def test_no_fault_gives_a_wrong_axis(fault: str) -> None:
    """Native frames have a checksum: a sample arrives with all its axes, or not at all."""
    faults = [parse_fault(fault)]
    blocks = list(faulty_blocks(islice(measure(RIG, load_motion("ramps"), 0, block_samples=500), 3), faults))
    sent = set()
    for block in blocks:
        assert isinstance(block, TriaxialBlock)
        for (seq, t_us, *_), (gyro_raw, accel_raw, _) in zip(block.rows(), block.axes_rows(), strict=True):
            sent.add((seq & 0xFFFF, t_us & 0xFFFFFFFF, *gyro_raw, *(accel_raw or [])))
    decoder = PROTOCOLS["native"].decoder()
    frames = faulty_frames(ENCODERS["native"].frames(iter(blocks), RIG.base), faults, 0)
    readings = [reading for frame in frames for reading in decoder.push(frame.content)]
    assert len(readings) > 800
    for reading in readings:
        assert reading.inertial is not None
        counts = np.rint(np.array(reading.inertial) / ([0.0152588] * 3 + [0.0023942] * 3))
        assert (reading.seq, reading.t_us, *counts.tolist()) in sent
