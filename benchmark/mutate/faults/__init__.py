"""All faults, by area."""

from mutate.fault import Fault
from mutate.faults import (
    axes,
    calibrate,
    config,
    device_yaw,
    diagnose,
    filters,
    firmware,
    firmware_sim,
    link,
    outputs,
    packet_sources,
    recording,
    service,
    session,
    sources,
)

FAULTS: tuple[Fault, ...] = tuple(
    fault
    for area in (
        axes,
        calibrate,
        link,
        device_yaw,
        session,
        sources,
        packet_sources,
        recording,
        service,
        outputs,
        config,
        filters,
        diagnose,
        firmware,
        firmware_sim,
    )
    for fault in area.FAULTS
)
