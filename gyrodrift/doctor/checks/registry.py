"""All checks in the order of the report. A further check is one function in a file of this package."""

from dataclasses import replace

import numpy as np

from gyrodrift.doctor.checks import aids, device_yaw, drift, gravity, line, noise, port, sensor, stream
from gyrodrift.doctor.evidence import DeviceEvidence
from gyrodrift.doctor.finding import DeviceFinding

CHECKS = (
    *port.CHECKS,
    *line.CHECKS,
    *stream.CHECKS,
    *sensor.CHECKS,
    *gravity.CHECKS,
    *device_yaw.CHECKS,
    *aids.CHECKS,
    *noise.CHECKS,
    *drift.CHECKS,
)


def examine(evidence: DeviceEvidence) -> list[DeviceFinding]:
    """Findings of all checks that have data."""
    with np.errstate(all="ignore"):  # a recording may hold numbers of any size
        findings = [(check.id, check.look(evidence)) for check in CHECKS]
    return [replace(finding, id=name) for name, finding in findings if finding is not None]
