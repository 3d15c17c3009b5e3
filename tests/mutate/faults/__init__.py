"""All faults, by area."""

from mutate.fault import Fault
from mutate.faults import (
    axes,
    calibrate,
    config,
    diagnose,
    filters,
    firmware_sim,
    link,
    outputs,
    recording,
    service,
    session,
)

FAULTS: tuple[Fault, ...] = tuple(
    fault
    for area in (axes, calibrate, link, session, recording, service, outputs, config, filters, diagnose, firmware_sim)
    for fault in area.FAULTS
)
