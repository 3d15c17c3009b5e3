"""State of the service as one record, for outputs (once a second), `ctl status` and `top`."""

from dataclasses import dataclass, field, make_dataclass
from typing import Any, Self

from gyrodrift.io.json_numbers import finite
from gyrodrift.outputs.fields import Use, fields_of
from gyrodrift.values.aid import AidStatus


@dataclass(frozen=True, slots=True)
class LinkStatus:
    """The serial link since the start; names as in `link_stats`.

    port, baud, protocol
        As opened; `protocol` is `unknown` until it was found.
    is_open
        Whether the port is open.
    silent_s
        Time since the last sample, s.
    rate_hz
        Samples per second over the last second.
    jitter_ms
        Peak-to-peak variation of the delay of samples over the last second, ms.
    samples, bytes, damaged, before_hello, clipped, impossible, gaps, missing, device_resets, reconnects
        Counters.
    gone_s
        Total time without the port, s.
    clock_ppm
        Rate of the device clock against the host clock, ppm; None until it is known.
    busy
        Used share of the capacity of the line, 0 to 1; 0 for a pty.
    """

    port: str = ""
    baud: int = 0
    protocol: str = "unknown"
    is_open: bool = False
    silent_s: float = 0.0
    rate_hz: float = 0.0
    jitter_ms: float = 0.0
    samples: int = 0
    bytes: int = 0
    damaged: int = 0
    before_hello: int = 0
    clipped: int = 0
    impossible: int = 0
    gaps: int = 0
    missing: int = 0
    device_resets: int = 0
    reconnects: int = 0
    gone_s: float = 0.0
    clock_ppm: float | None = None
    busy: float = 0.0


@dataclass(frozen=True, slots=True)
class DeviceStatus:
    """Description by the device itself; None for missing values.

    device_filter
        Name of the filter that the device runs itself.
    """

    device_id: str | None = None
    sample_rate_hz: float | None = None
    dps_per_lsb: float | None = None
    encoder_cpr: int | None = None
    device_filter: str | None = None


_FieldStatus: Any = make_dataclass(
    "_FieldStatus",
    [
        (entry.name, float | None, 0.0 if entry.name in {"yaw_deg", "bias_dps"} else None)
        for entry in fields_of(Use.STATUS)
    ],
    frozen=True,
    slots=True,
    kw_only=True,
)
"""Values of the table of fields; None if unknown."""


@dataclass(frozen=True, slots=True)
class FilterStatus(_FieldStatus):  # type: ignore[misc]  # the attributes of its base are the records of a table
    """The filter after the last sample: values of the table of fields, and what no sample has. None if unknown.

    scale_sigma_deg
        Share of `yaw_sigma_deg` from the scale factor.
    rejected
        Number of rejected samples.
    still, is_witness_believed
        Last statement of a witness of rest, 1 for rest and 0 for motion, and whether it is believed.
    temp_curve
        Bias against temperature: `points`, `slope_dps_c`, `slope_sigma_dps_c`.
    aids
        Second sources by name: `age_s`, `weight` and `differs`; None without any.
    """

    name: str = ""
    scale_sigma_deg: float | None = None
    rejected: int = 0
    still: float | None = None
    is_witness_believed: bool | None = None
    temp_curve: dict[str, float] | None = None
    aids: dict[str, dict[str, Any]] | None = None


@dataclass(frozen=True, slots=True)
class ConfigStatus:
    """The config in force.

    file
        None without a config.
    filter, params
        The filter and its parameters.
    applied, refused
        Number of configs applied and refused since the start.
    applied_s
        Unix time of the last applied config, s; None before.
    mount
        Axes of the sensor that point `up` and `forward` on the device, such as `+z` and `+x`; None with one axis.
    calibration
        Date, sign and scales of the calibration in force; None without one.
    """

    file: str | None = None
    filter: str = ""
    params: dict[str, float] = field(default_factory=dict)
    applied: int = 0
    refused: int = 0
    applied_s: float | None = None
    mount: dict[str, str] | None = None
    calibration: dict[str, Any] | None = None


@dataclass(frozen=True, slots=True)
class ClientStatus:
    """A client of an output.

    peer
        Address, or process id for a unix socket.
    sent, dropped
        Messages sent, and dropped because it was too slow.
    """

    peer: str
    sent: int = 0
    dropped: int = 0


@dataclass(frozen=True, slots=True)
class OutputStatus:
    """One output.

    output
        Argument of `--output`.
    address
        Address that it listens on or sends to; empty while it is closed.
    problem
        Reason why it is closed; empty while it is open.
    clients
        The first MOST_CLIENTS clients; `client_count` is the number of all.
    sent, dropped
        Messages to all clients since the output was opened, with former clients.
    warning
        Problem of an open output; empty without one.
    """

    output: str
    address: str = ""
    problem: str = ""
    clients: tuple[ClientStatus, ...] = ()
    client_count: int = 0
    sent: int = 0
    dropped: int = 0
    warning: str = ""


MOST_CLIENTS = 32


@dataclass(frozen=True, slots=True)
class ServiceStatus:
    """The whole service.

    started_s
        Unix time, s.
    memory_bytes
        Resident memory of the service and of the process of the outputs.
    dropped
        Samples dropped because the process of the outputs was too slow.
    memory
        Memory of the filter: `file`, `state` (none, new, used or refused), `reason`, `device`; None without.
    recording
        File that is being written; None while nothing is recorded.
    """

    version: str = ""
    pid: int = 0
    started_s: float = 0.0
    uptime_s: float = 0.0
    memory_bytes: int = 0
    dropped: int = 0
    link: LinkStatus = field(default_factory=LinkStatus)
    device: DeviceStatus = field(default_factory=DeviceStatus)
    filter: FilterStatus = field(default_factory=FilterStatus)
    config: ConfigStatus = field(default_factory=ConfigStatus)
    outputs: tuple[OutputStatus, ...] = ()
    memory: dict[str, str] | None = None
    recording: str | None = None

    @classmethod
    def from_dict(cls, values: dict[str, Any]) -> Self:
        """Build from plain values."""
        records = {
            "link": LinkStatus(**values["link"]),
            "device": DeviceStatus(**values["device"]),
            "filter": FilterStatus(**values["filter"]),
            "config": ConfigStatus(**values["config"]),
            "outputs": tuple(output_status(output) for output in values["outputs"]),
        }
        return cls(**(values | records))


def aid_status(status: AidStatus) -> dict[str, Any]:
    """Status of a second source as plain values; None for what is unknown."""
    values = {"age_s": status.age_s, "weight": status.weight}
    return {**{name: finite(round(value, 3)) for name, value in values.items()}, "differs": status.differs or None}


def aid_text(aid: dict[str, Any]) -> str:
    """Age and weight of a second source, for people."""
    if aid["differs"]:
        return "left out"
    age = "no measurement" if aid["age_s"] is None else f"{aid['age_s']:.1f} s ago"
    return age if aid["weight"] is None else f"{age}, {aid['weight']:.0%} agree"


def output_status(values: dict[str, Any]) -> OutputStatus:
    """Build from plain values."""
    return OutputStatus(**(values | {"clients": tuple(ClientStatus(**client) for client in values["clients"])}))
