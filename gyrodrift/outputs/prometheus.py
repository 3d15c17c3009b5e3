"""A page of counters and gauges for Prometheus to scrape: the link, the filter, the config and the outputs."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from http import HTTPStatus
from typing import TYPE_CHECKING, Annotated

from gyrodrift.outputs.net.names import well_formed
from gyrodrift.outputs.net.websocket import WebSocketClient, WebSocketServer, WebSocketSession
from gyrodrift.outputs.options import LOOPBACK, About, Host, Port
from gyrodrift.outputs.output import Output, OutputHost
from gyrodrift.outputs.status import ServiceStatus

if TYPE_CHECKING:
    from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily
    from prometheus_client.metrics_core import Metric
    from prometheus_client.registry import CollectorRegistry
    from websockets.asyncio.server import ServerConnection
    from websockets.http11 import Request, Response

PATH = "/metrics"


@dataclass(frozen=True, slots=True)
class PrometheusOptions:
    """Where."""

    host: Annotated[Host, About("address to listen on")] = LOOPBACK
    port: Annotated[Port, About("port to listen on; 0 takes a free one")] = 9817


class PrometheusOutput(Output[PrometheusOptions]):
    """Answers each request with the state of the last second."""

    options_type = PrometheusOptions

    def __init__(self, options: PrometheusOptions, host: OutputHost) -> None:
        super().__init__(options, host)
        self._server = WebSocketServer(_no_session, host.log, self._answer)
        self._registry: CollectorRegistry | None = None
        self._scrapes = 0

    async def open(self) -> None:
        """Begin to listen."""
        from prometheus_client import CollectorRegistry

        self._registry = CollectorRegistry()
        self._registry.register(_StatusCollector(self.host))
        self.address = await self._server.listen(self.options.host, self.options.port)

    def counts(self) -> tuple[int, int]:
        """Scrapes."""
        return self._scrapes, 0

    async def close(self) -> None:
        """Stop to listen."""
        await self._server.close()

    def _answer(self, connection: "ServerConnection", request: "Request") -> "Response":
        if request.path.partition("?")[0] != PATH:
            return connection.respond(HTTPStatus.NOT_FOUND, f"metrics are at {PATH}\n")
        assert self._registry is not None  # noqa: S101 - made before the server listens
        encode, content_type = _encoder_for(", ".join(request.headers.get_all("Accept")))
        response = connection.respond(HTTPStatus.OK, encode(self._registry).decode())
        del response.headers["Content-Type"]
        response.headers["Content-Type"] = content_type
        self._scrapes += 1
        return response


def _encoder_for(accept: str) -> "tuple[Callable[[CollectorRegistry], bytes], str]":
    """How to write the page, and its content type; plain text where the library cannot read the header."""
    from prometheus_client.exposition import choose_encoder

    try:
        return choose_encoder(accept.replace('"', ""))  # it takes a quoted parameter for a part of the version
    except (TypeError, ValueError):
        return choose_encoder("")


class _StatusCollector:
    """What a registry of prometheus-client asks at each scrape."""

    def __init__(self, host: OutputHost) -> None:
        self._host = host

    def describe(self) -> "list[Metric]":
        """Nothing before the first scrape."""
        return []

    def collect(self) -> "Iterator[Metric]":
        """All metrics of the last second; what is not known is left out."""
        status = self._host.status
        for name, about, count in _counters(status):
            yield _counter(name, about, count)
        for name, about, value in _gauges(status):
            if value is not None:
                yield _gauge(name, about, value)
        yield from _of_outputs(status)
        yield _identity(status)


def _counters(status: ServiceStatus) -> Iterator[tuple[str, str, float]]:
    link = status.link
    yield "link_samples", "Samples that arrived.", link.samples
    yield "link_bytes", "Bytes that arrived.", link.bytes
    yield "link_damaged", "Frames that arrived damaged.", link.damaged
    yield "link_before_hello", "Frames that came before the device had said what it is.", link.before_hello
    yield "link_clipped", "Samples that left the range of the sensor.", link.clipped
    yield "link_gaps", "Gaps in the samples.", link.gaps
    yield "link_missing", "Samples that were lost in gaps.", link.missing
    yield "link_device_resets", "How often the device began anew.", link.device_resets
    yield "link_reconnects", "How often the port came back.", link.reconnects
    yield "link_gone_seconds", "For how long the port was gone.", link.gone_s
    yield "filter_rejected", "Samples that the filter passed by.", status.filter.rejected
    yield "config_applied", "How often the config file was taken.", status.config.applied
    yield "config_refused", "How often the config file had mistakes.", status.config.refused
    yield "outputs_samples_dropped", "Samples that the process of the outputs was too slow for.", status.dropped


def _gauges(status: ServiceStatus) -> Iterator[tuple[str, str, float | None]]:
    link, state = status.link, status.filter
    yield "link_open", "1 while the port is there.", link.is_open
    yield "link_rate_hertz", "Samples per second over the last second.", link.rate_hz
    yield "link_jitter_seconds", "Peak-to-peak variation of the delay over the last second.", link.jitter_ms / 1e3
    yield "link_silent_seconds", "How long no sample has come.", link.silent_s
    yield "link_clock_ppm", "Rate of the device clock against the host's, parts per million.", link.clock_ppm
    yield "link_busy_ratio", "Share of the line's capacity that is used.", link.busy
    yield "yaw_degrees", "Unwrapped yaw, counter-clockwise.", state.yaw_deg
    yield "yaw_sigma_degrees", "Standard deviation of yaw.", state.yaw_sigma_deg
    yield "heading_degrees", "Compass heading, clockwise, 0 to 360.", state.heading_deg
    yield "drift_degrees_per_second", "The drift estimate.", state.bias_dps
    yield "drift_sigma_degrees_per_second", "Standard deviation of the drift estimate.", state.bias_sigma_dps
    yield "rest_probability_ratio", "How probable it is that the device is at rest.", state.rest_probability
    yield "confidence_ratio", "How probable what the filter believes is.", state.confidence
    yield "temperature_celsius", "Temperature of the sensor.", state.temp_c
    yield "memory_bytes", "Resident memory of the service and of the process of its outputs.", status.memory_bytes
    yield "start_time_seconds", "Unix time of the start of the service.", status.started_s


def _of_outputs(status: ServiceStatus) -> "Iterator[Metric]":
    outputs = {well_formed(each.output): each for each in status.outputs}
    up = _gauge("output_open", "1 while the output is open.", labels=("output",))
    clients = _gauge("output_clients", "Who listens to the output.", labels=("output",))
    sent = _counter("output_sent", "Messages sent.", labels=("output",))
    dropped = _counter("output_dropped", "Messages that clients were too slow for.", labels=("output",))
    for name, each in outputs.items():
        up.add_metric([name], not each.problem)
        clients.add_metric([name], each.client_count)
        sent.add_metric([name], each.sent)
        dropped.add_metric([name], each.dropped)
    yield from (up, clients, sent, dropped)


def _identity(status: ServiceStatus) -> "Metric":
    from prometheus_client.core import InfoMetricFamily

    said = {
        "version": status.version,
        "port": status.link.port,
        "protocol": status.link.protocol,
        "device": status.device.device_id or "",
        "filter": status.filter.name,
    }
    labels = {name: well_formed(value) for name, value in said.items()}
    return InfoMetricFamily("gyrodrift", "Program, device and filter.", labels)


def _gauge(name: str, about: str, value: float | None = None, labels: tuple[str, ...] = ()) -> "GaugeMetricFamily":
    from prometheus_client.core import GaugeMetricFamily

    return GaugeMetricFamily(f"gyrodrift_{name}", about, value, labels or None)


def _counter(name: str, about: str, value: float | None = None, labels: tuple[str, ...] = ()) -> "CounterMetricFamily":
    from prometheus_client.core import CounterMetricFamily

    return CounterMetricFamily(f"gyrodrift_{name}", about, value, labels or None)


def _no_session(_client: WebSocketClient) -> WebSocketSession:
    raise RuntimeError("a page of metrics has no session: every request is answered before")
