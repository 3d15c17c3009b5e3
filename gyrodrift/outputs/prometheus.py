"""A page of counters and gauges for Prometheus to scrape: the link, the filter, the config and the outputs."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from http import HTTPStatus
from typing import TYPE_CHECKING, Annotated

from gyrodrift.outputs.fields import Field, Use, fields_of
from gyrodrift.outputs.net.addresses import well_formed
from gyrodrift.outputs.net.servers import ServerOutput
from gyrodrift.outputs.net.websocket import WebSocketClient, WebSocketServer, WebSocketSession
from gyrodrift.outputs.options import LOOPBACK, About, Host, Port
from gyrodrift.outputs.output import OutputHost
from gyrodrift.outputs.status import ServiceStatus

if TYPE_CHECKING:
    from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily
    from prometheus_client.metrics_core import Metric
    from prometheus_client.registry import CollectorRegistry
    from websockets.asyncio.server import ServerConnection
    from websockets.http11 import Request, Response

PATH = "/metrics"
UNITS = {"deg": "degrees", "deg/s": "degrees_per_second", "°C": "celsius", "": "ratio"}
WORDS = {"bias": "drift", "temp": "temperature"}
"""Units and words of metric names (Prometheus, "Metric and label naming")."""


@dataclass(frozen=True, slots=True)
class PrometheusOptions:
    """Address."""

    host: Annotated[Host, About("address to listen on")] = LOOPBACK
    port: Annotated[Port, About("port to listen on; 0 takes a free one")] = 9817


class PrometheusOutput(ServerOutput[PrometheusOptions, WebSocketServer[WebSocketSession]]):
    """Answers each request with the state of the last second."""

    options_type = PrometheusOptions

    def __init__(self, options: PrometheusOptions, host: OutputHost) -> None:
        super().__init__(options, host)
        self.server = WebSocketServer(_no_session, host.log, self._answer)
        self._registry: CollectorRegistry | None = None
        self._scrapes = 0

    async def open(self) -> None:
        """Begin to listen."""
        from prometheus_client import CollectorRegistry

        self._registry = CollectorRegistry()
        self._registry.register(_StatusCollector(self.host))
        self.address = await self.server.listen(self.options.host, self.options.port)

    def counts(self) -> tuple[int, int]:
        """Number of scrapes."""
        return self._scrapes, 0

    def _answer(self, connection: "ServerConnection", request: "Request") -> "Response":
        if request.path.partition("?")[0] != PATH:
            return connection.respond(HTTPStatus.NOT_FOUND, f"metrics are at {PATH}\n")
        assert self._registry is not None  # noqa: S101 - set before the server listens
        encode, content_type = _encoder_for(", ".join(request.headers.get_all("Accept")))
        response = connection.respond(HTTPStatus.OK, encode(self._registry).decode())
        del response.headers["Content-Type"]
        response.headers["Content-Type"] = content_type
        self._scrapes += 1
        return response


def _encoder_for(accept: str) -> "tuple[Callable[[CollectorRegistry], bytes], str]":
    """Encoder and content type for an Accept header; plain text if the library cannot read it."""
    from prometheus_client.exposition import choose_encoder

    try:
        return choose_encoder(accept.replace('"', ""))  # the library would read quotes as part of the version
    except (TypeError, ValueError):
        return choose_encoder("")


class _StatusCollector:
    """Collector for a registry of prometheus-client."""

    def __init__(self, host: OutputHost) -> None:
        self._host = host

    def describe(self) -> "list[Metric]":
        """No metrics before the first scrape."""
        return []

    def collect(self) -> "Iterator[Metric]":
        """Metrics of the last second, without unknown values."""
        status = self._host.status
        for name, about, count in _counters(status):
            yield _counter(name, about, count)
        for name, about, value in gauges(status):
            if value is not None:
                yield _gauge(name, about, value)
        yield from _of_aids(status)
        yield from _of_outputs(status)
        yield _identity(status)


def _counters(status: ServiceStatus) -> Iterator[tuple[str, str, float]]:
    link = status.link
    yield "link_samples", "Samples that arrived.", link.samples
    yield "link_bytes", "Bytes that arrived.", link.bytes
    yield "link_damaged", "Damaged frames.", link.damaged
    yield "link_before_hello", "Frames before the first HELLO of the device.", link.before_hello
    yield "link_clipped", "Samples out of the range of the sensor.", link.clipped
    yield "link_impossible", "Samples with a rate that cannot be.", link.impossible
    yield "link_gaps", "Gaps in the samples.", link.gaps
    yield "link_missing", "Lost samples.", link.missing
    yield "link_device_resets", "Restarts of the device.", link.device_resets
    yield "link_reconnects", "Reconnects of the port.", link.reconnects
    yield "link_gone_seconds", "Time without the port.", link.gone_s
    yield "filter_rejected", "Samples rejected by the filter.", status.filter.rejected
    yield "config_applied", "Configs applied.", status.config.applied
    yield "config_refused", "Configs refused.", status.config.refused
    yield "outputs_samples_dropped", "Samples dropped because the process of the outputs was too slow.", status.dropped


def gauges(status: ServiceStatus) -> Iterator[tuple[str, str, float | None]]:
    """Name, description and value of the gauges; None for unknown values."""
    link = status.link
    yield "link_open", "1 while the port is open.", link.is_open
    yield "link_rate_hertz", "Samples per second over the last second.", link.rate_hz
    yield "link_jitter_seconds", "Peak-to-peak variation of the delay over the last second.", link.jitter_ms / 1e3
    yield "link_silent_seconds", "Time since the last sample.", link.silent_s
    yield "link_clock_ppm", "Rate of the device clock against the host clock, parts per million.", link.clock_ppm
    yield "link_busy_ratio", "Used share of the capacity of the line.", link.busy
    for field in fields_of(Use.STATUS):
        yield metric_name(field), field.description, getattr(status.filter, field.name)
    yield "memory_bytes", "Resident memory of the service and of the process of its outputs.", status.memory_bytes
    yield "start_time_seconds", "Unix time of the start of the service.", status.started_s


def metric_name(field: Field) -> str:
    """Name of the gauge of a field, with its unit in full."""
    words = field.name.split("_")[: -1 if field.unit else None]
    return "_".join([*(WORDS.get(word, word) for word in words), UNITS[field.unit]])


def _of_aids(status: ServiceStatus) -> "Iterator[Metric]":
    if not status.filter.aids:
        return
    age = _gauge("aid_age_seconds", "Time since the last measurement of a second source.", labels=("name",))
    weight = _gauge("aid_weight_ratio", "Share of its last measurements that agree; 0 if left out.", labels=("name",))
    for name, aid in status.filter.aids.items():
        for metric, value in ((age, aid["age_s"]), (weight, aid["weight"])):
            if value is not None:
                metric.add_metric([well_formed(name)], value)
    yield from (age, weight)


def _of_outputs(status: ServiceStatus) -> "Iterator[Metric]":
    outputs = {well_formed(output.output): output for output in status.outputs}
    up = _gauge("output_open", "1 while the output is open.", labels=("output",))
    clients = _gauge("output_clients", "Clients of the output.", labels=("output",))
    sent = _counter("output_sent", "Messages sent.", labels=("output",))
    dropped = _counter("output_dropped", "Messages dropped for slow clients.", labels=("output",))
    for name, output in outputs.items():
        up.add_metric([name], not output.problem)
        clients.add_metric([name], output.client_count)
        sent.add_metric([name], output.sent)
        dropped.add_metric([name], output.dropped)
    yield from (up, clients, sent, dropped)


def _identity(status: ServiceStatus) -> "Metric":
    from prometheus_client.core import InfoMetricFamily

    values = {
        "version": status.version,
        "port": status.link.port,
        "protocol": status.link.protocol,
        "device": status.device.device_id or "",
        "filter": status.filter.name,
    }
    labels = {name: well_formed(value) for name, value in values.items()}
    return InfoMetricFamily("gyrodrift", "Program, device and filter.", labels)


def _gauge(name: str, about: str, value: float | None = None, labels: tuple[str, ...] = ()) -> "GaugeMetricFamily":
    from prometheus_client.core import GaugeMetricFamily

    return GaugeMetricFamily(f"gyrodrift_{name}", about, value, labels or None)


def _counter(name: str, about: str, value: float | None = None, labels: tuple[str, ...] = ()) -> "CounterMetricFamily":
    from prometheus_client.core import CounterMetricFamily

    return CounterMetricFamily(f"gyrodrift_{name}", about, value, labels or None)


def _no_session(_client: WebSocketClient) -> WebSocketSession:
    raise RuntimeError("a page of metrics has no session")
