"""The state of the service as outputs, `ctl status` and `top` are told it, once a second: one record, as JSON."""

import json
from dataclasses import asdict, dataclass, field
from typing import Any, Self


@dataclass(frozen=True, slots=True)
class LinkStatus:
    """The serial link since the start; the names are those of `link_stats`.

    port, baud, protocol
        As opened; `protocol` is `unknown` until bytes have shown it.
    is_open
        The port is there.
    silent_s
        How long no sample has come, s.
    rate_hz
        Samples per second over the last second.
    jitter_ms
        Peak-to-peak variation over the last second of how long samples took from the device's clock to here, ms.
    samples, bytes, damaged, before_hello, clipped, gaps, missing, device_resets, reconnects
        Counters.
    gone_s
        For how long the port was gone, s.
    clock_ppm
        Rate of the device clock against the host's; None until known.
    busy
        Share of the line's capacity that is used, 0 to 1; 0 for a pty.
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
    gaps: int = 0
    missing: int = 0
    device_resets: int = 0
    reconnects: int = 0
    gone_s: float = 0.0
    clock_ppm: float | None = None
    busy: float = 0.0


@dataclass(frozen=True, slots=True)
class DeviceStatus:
    """What the device says of itself; None where it does not."""

    device_id: str | None = None
    sample_rate_hz: float | None = None
    dps_per_lsb: float | None = None
    encoder_cpr: int | None = None


@dataclass(frozen=True, slots=True)
class FilterStatus:
    """The filter after the last sample; None for what it does not say.

    scale_sigma_deg
        Share of `yaw_sigma_deg` from the scale factor.
    heading_deg
        Compass heading, clockwise from north, 0 to 360; None until a reference was given.
    rejected
        Samples that it passed by.
    still, is_witness_believed
        What was said last of rest beside the rate, 1 stands still and 0 moves, and whether that is believed.
    temp_curve
        Bias against temperature: `is_accepted`, `slope_dps_c`, `fit_dps`, `points`, `least_c`, `most_c`, `refused`.
    """

    name: str = ""
    yaw_deg: float = 0.0
    yaw_sigma_deg: float | None = None
    scale_sigma_deg: float | None = None
    bias_dps: float = 0.0
    bias_sigma_dps: float | None = None
    rest_probability: float | None = None
    confidence: float | None = None
    heading_deg: float | None = None
    temp_c: float | None = None
    rejected: int = 0
    still: float | None = None
    is_witness_believed: bool | None = None
    temp_curve: dict[str, float] | None = None


@dataclass(frozen=True, slots=True)
class ConfigStatus:
    """The config in force.

    file
        None where the service runs without one.
    filter, params
        The filter and its parameters.
    applied, refused
        How often the file was taken since the start, and how often it had mistakes.
    applied_s
        Unix time of the last time it was taken, s; None before.
    """

    file: str | None = None
    filter: str = ""
    params: dict[str, float] = field(default_factory=dict)
    applied: int = 0
    refused: int = 0
    applied_s: float | None = None


@dataclass(frozen=True, slots=True)
class ClientStatus:
    """One who listens to an output.

    peer
        Address, or process id for a unix socket.
    sent, dropped
        Messages that it was sent, and those it was too slow for.
    """

    peer: str
    sent: int = 0
    dropped: int = 0


@dataclass(frozen=True, slots=True)
class OutputStatus:
    """One output.

    output
        As `--output` has it.
    address
        Where it listens or sends to; empty while it is not open.
    problem
        Why it is not open; empty where it is.
    clients
        Who listens, the first MOST_CLIENTS of them; `client_count` is all of them.
    sent, dropped
        Messages to all clients since the start of the output, those that are gone too.
    warning
        What is wrong although it is open; empty where nothing is.
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
    """All of it.

    started_s
        Unix time, s.
    memory_bytes
        Resident memory of the service and of the outputs' process.
    dropped
        Samples that the outputs' process was too slow for.
    memory
        Of what the filter remembers: `file`, `state` (none, new, used or refused), `reason`, `device`; None without.
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

    def to_json(self) -> str:
        """One line."""
        return json.dumps(asdict(self), separators=(",", ":"), allow_nan=False)

    @classmethod
    def from_json(cls, text: str | bytes) -> Self:
        """What `to_json` wrote."""
        return cls.from_dict(json.loads(text))

    @classmethod
    def from_dict(cls, given: dict[str, Any]) -> Self:
        """Of plain values."""
        records = {
            "link": LinkStatus(**given["link"]),
            "device": DeviceStatus(**given["device"]),
            "filter": FilterStatus(**given["filter"]),
            "config": ConfigStatus(**given["config"]),
            "outputs": tuple(output_status(each) for each in given["outputs"]),
        }
        return cls(**(given | records))


def output_status(given: dict[str, Any]) -> OutputStatus:
    """Of plain values."""
    return OutputStatus(**(given | {"clients": tuple(ClientStatus(**each) for each in given["clients"])}))
