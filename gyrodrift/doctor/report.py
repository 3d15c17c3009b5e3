"""A report for other people: device, versions, ten seconds of data and the checks, in one file without secrets."""

import json
import platform
import socket
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import numpy as np

from gyrodrift import __version__
from gyrodrift.doctor.evidence import DeviceEvidence
from gyrodrift.doctor.finding import DeviceFinding, as_json
from gyrodrift.io.json_numbers import finite
from gyrodrift.session.session import ARRAYS
from gyrodrift.values.secret import HIDDEN, without_secrets

FORMAT = 1
"""Version of the file; it grows with a change of meaning."""

DATA_S = 10.0
"""Length of the data in a report, s: a rest and its noise, and at 1 kHz a file of a megabyte."""

MOST_SAMPLES = 20_000
"""Largest number of samples in a report. Chosen: 2 kHz for ten seconds."""

PACKAGES = ("numpy", "pyserial", "mcap", "pydantic", "structlog")
"""Packages whose versions matter for reading a device."""


def report(examined: Sequence[tuple[DeviceEvidence, Sequence[DeviceFinding]]], plug_ins: Sequence[str]) -> str:
    """Text of the report, JSON, with a block for each device or recording."""
    content = {
        "gyrodrift_report": FORMAT,
        "versions": _versions(),
        "plug_ins": list(plug_ins),
        "devices": [_device(evidence, findings) for evidence, findings in examined],
    }
    private = [text for evidence, _ in examined for text in _private(evidence)]
    return json.dumps(_public(content, private), ensure_ascii=False, indent=1, allow_nan=False) + "\n"


def _versions() -> dict[str, str]:
    system = {"system": platform.system(), "kernel": platform.release(), "machine": platform.machine()}
    return {"gyrodrift": __version__, "python": platform.python_version()} | system | _package_versions()


def _package_versions() -> dict[str, str]:
    versions = {}
    for name in PACKAGES:
        try:
            versions[name] = version(name)
        except PackageNotFoundError:
            versions[name] = "missing"
    return versions


def _device(evidence: DeviceEvidence, findings: Sequence[DeviceFinding]) -> dict[str, Any]:
    port = evidence.port
    adapter = {} if port is None else {"maker": port.port.maker, "product": port.port.product, "usb": port.port.usb_id}
    return {
        "adapter": adapter | ({} if port is None else {"driver": port.driver, "latency_ms": port.latency_ms}),
        "device": _finite(asdict(evidence.device)),
        "link": _finite(asdict(evidence.link)),
        "sensor": evidence.sensor.name if evidence.sensor else None,
        "checks": json.loads(as_json(evidence.source, findings)),
        "data": _data(evidence),
        "not_understood": "" if evidence.facts is not None else evidence.raw.decode("latin-1"),
    }


def _data(evidence: DeviceEvidence) -> dict[str, list[float | None]]:
    """Columns of the first ten seconds."""
    if evidence.facts is None:
        return {}
    session = evidence.facts.session
    times_s = session.t_device_s
    count = min(int(np.searchsorted(times_s, times_s[0] + DATA_S)), MOST_SAMPLES)
    columns = {name: getattr(session, name) for name in ARRAYS}
    for name, axes in (("gyro", session.gyro_dps), ("accel", session.accel_mps2)):
        unit = "dps" if name == "gyro" else "mps2"
        columns |= {f"{name}_{axis}_{unit}": axes[:, i] for i, axis in enumerate("xyz")} if axes is not None else {}
    return {name: [finite(float(x)) for x in values[:count]] for name, values in columns.items() if values is not None}


def _finite(values: Mapping[str, Any]) -> dict[str, Any]:
    return {name: finite(value) if isinstance(value, float) else value for name, value in values.items()}


def _private(evidence: DeviceEvidence) -> list[str]:
    """Texts that name a machine or a person: folder of the user, host, serial number of the adapter."""
    serial = evidence.port.port.serial_number if evidence.port else None
    return [str(Path.home()), socket.gethostname(), *([serial] if serial else [])]


def _public(value: Any, private: Sequence[str]) -> Any:
    """A value in which each text has neither secrets nor private texts."""
    if isinstance(value, str):
        text = without_secrets(value)
        for name in private:
            text = text.replace(name, HIDDEN) if len(name) > 2 else text
        return text
    if isinstance(value, dict):
        return {key: _public(inner, private) for key, inner in value.items()}
    return [_public(inner, private) for inner in value] if isinstance(value, list) else value
