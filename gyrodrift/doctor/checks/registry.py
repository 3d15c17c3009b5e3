"""All checks in the order in which they are told; one more is one more record in a file of this package."""

from dataclasses import replace

import numpy as np

from gyrodrift.doctor.checks import drift, line, noise, port, sensor, stream
from gyrodrift.doctor.evidence import DeviceEvidence
from gyrodrift.doctor.finding import DeviceFinding

CHECKS = (*port.CHECKS, *line.CHECKS, *stream.CHECKS, *sensor.CHECKS, *noise.CHECKS, *drift.CHECKS)


def examine(evidence: DeviceEvidence) -> list[DeviceFinding]:
    """What each check finds, in their order."""
    with np.errstate(all="ignore"):  # a recording may hold numbers of any size
        found = [(check.id, check.look(evidence)) for check in CHECKS]
    return [replace(each, id=name) for name, each in found if each is not None]
