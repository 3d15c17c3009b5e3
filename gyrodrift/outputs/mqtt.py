"""State topics on an MQTT broker, with availability by last will, and discovery by Home Assistant."""

import asyncio
import contextlib
import json
import logging
import re
import socket
import ssl
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from annotated_types import MaxLen, MinLen

from gyrodrift import __version__
from gyrodrift.io.files import UnreadableError, read_ordinary
from gyrodrift.io.paho_guard import PahoGuard
from gyrodrift.outputs.fields import CHOICES
from gyrodrift.outputs.health import health
from gyrodrift.outputs.home_assistant import BIRTH, OFFLINE, ONLINE, Topics, discovery
from gyrodrift.outputs.json_line import present_fields
from gyrodrift.outputs.net.addresses import shown
from gyrodrift.outputs.net.limits import Allowance, Backlog, Limits
from gyrodrift.outputs.options import LOOPBACK, About, Host, Port, Rate
from gyrodrift.outputs.output import Output, OutputError, OutputHost
from gyrodrift.outputs.status import DeviceStatus, ServiceStatus
from gyrodrift.outputs.thinning import Thinning
from gyrodrift.values.sample import Corrected
from gyrodrift.values.secret import NO_SECRET, SecretText

if TYPE_CHECKING:
    import aiomqtt

LONGEST_PACKET_BYTES = 16 << 10
"""Longest packet. A broker answers with a few bytes, and the birth message of Home Assistant is a word."""

READS_PER_S = 1000.0
"""Most reads a second; a packet takes three or four."""


class BrokerGuard(PahoGuard):
    """Ends the connection to a broker that sends too much, or too often."""

    def __init__(self, client: "aiomqtt.Client") -> None:
        super().__init__(client._client, LONGEST_PACKET_BYTES)  # noqa: SLF001 - no public name
        self._allowance = Allowance(READS_PER_S)

    def receive(self, longest_bytes: int) -> bytes:
        """Read, unless there were too many reads."""
        content = super().receive(longest_bytes)
        if not self._allowance.take():
            self.refuse(f"more than {READS_PER_S / 4:g} packets a second")
        return content


PLAIN_PORT, TLS_PORT = 1883, 8883
ANSWER_S = 10.0
"""Longest time of a broker for a connection or a message, s."""
FAREWELL_S = 1.0
LINK_EVERY_S = 10.0
AT_LEAST_ONCE = 1
LONGEST_PEM_BYTES = 1 << 20
"""Largest file of certificates; those of all authorities of a system have 200 kB."""

LONGEST_PASSWORD_BYTES = (64 << 10) - 1
"""Longest password in bytes: its length field has 16 bits (MQTT 3.1.1, 3.1.3.5)."""

Text = Annotated[str, MaxLen(1024)]


@dataclass(frozen=True, slots=True)
class MqttOptions:
    """Broker, credentials and topics."""

    host: Annotated[Host, About("name or address of the broker")] = LOOPBACK
    port: Annotated[Port | None, About(f"port of the broker; {PLAIN_PORT}, or {TLS_PORT} with tls, if empty")] = None
    rate_hz: Annotated[Rate, About("at most this many states a second of device time")] = 1.0
    id: Annotated[
        str, MaxLen(64), About("name of this service in topics: letters, digits, _ and -; name of this host if empty")
    ] = ""
    topic: Annotated[str, MinLen(1), MaxLen(256), About("beginning of the topics")] = "gyrodrift"
    discovery: Annotated[
        str, MaxLen(256), About("beginning of the discovery topics of Home Assistant; no discovery if empty")
    ] = "homeassistant"
    user: Annotated[Text, About("user name at the broker")] = ""
    password: Annotated[SecretText, About("password of the user; better in password_file")] = NO_SECRET
    password_file: Annotated[Text, About("file that holds only the password")] = ""
    tls: Annotated[bool, About("use TLS, and check the certificate of the broker")] = False
    ca: Annotated[Text, About("file of certificates to trust; the system certificates if empty")] = ""
    certificate: Annotated[Text, About("file of a client certificate")] = ""
    key: Annotated[Text, About("file of its key, if it is a separate file")] = ""


class MqttOutput(Output[MqttOptions]):
    """One connection to a broker; the hub of the outputs reconnects it."""

    options_type = MqttOptions

    def __init__(self, options: MqttOptions, host: OutputHost) -> None:
        super().__init__(options, host)
        own_name = f"gyrodrift-{re.sub(r'[^a-zA-Z0-9_-]', '-', socket.gethostname())}"
        self._name = options.id or "-".join(filter(None, (own_name, host.source)))
        self._topics = Topics.of(options.topic, self._name)
        self._config_topic = f"{options.discovery}/device/{self._name}/config"
        self._birth_topic = f"{options.discovery}/status"
        self._thinning = Thinning(options.rate_hz)
        self._states: Backlog[bytes] = Backlog(Limits().queue_bytes)
        self._retained: dict[str, str] = {}
        self._has_news = asyncio.Event()
        self._client: aiomqtt.Client | None = None
        self._guard: BrokerGuard | None = None
        self._tasks: list[asyncio.Task[None]] = []
        self._sent = 0
        self._announced: DeviceStatus | None = None
        self._has_axes = False
        self._was_open: bool | None = None
        self._link_due_s = 0.0

    @classmethod
    def exclusive_resources(cls, options: MqttOptions) -> frozenset[str]:
        """Client name at the broker, which accepts one client per name."""
        return frozenset([f"mqtt {options.host} {options.id}"])

    async def open(self) -> None:
        """Connect, and announce the entities."""
        import aiomqtt

        self._check_names()
        port = self.options.port or (TLS_PORT if self.options.tls else PLAIN_PORT)
        where = shown(self.options.host, port)
        self._client = aiomqtt.Client(
            self.options.host,
            port,
            username=self.options.user or None,
            password=self._password() or None,
            will=aiomqtt.Will(self._topics.availability, OFFLINE, AT_LEAST_ONCE, retain=True),
            tls_context=self._tls(),
            timeout=ANSWER_S,
            max_queued_incoming_messages=Limits().clients,
            logger=_silent(),
        )
        self._guard = BrokerGuard(self._client)
        try:
            await self._client.__aenter__()
            await self._client.publish(self._topics.availability, ONLINE, AT_LEAST_ONCE, retain=True)
            if self.options.discovery:
                await self._client.subscribe(self._birth_topic)
        except aiomqtt.MqttError as error:
            why = self._guard.problem or f"the broker at {where} refuses the connection: {error}"
            raise OutputError(why) from error
        self.address = f"{where}/{self._topics.state}"
        self._tasks = [
            asyncio.create_task(self._publish(self._client)),
            asyncio.create_task(self._listen(self._client)),
        ]
        self.note(self.host.status)

    def take(self, samples: Sequence[Corrected]) -> None:
        """Publish the states that are due."""
        self._check_connection()
        if not self._has_axes and samples[-1].attitude is not None:
            self._has_axes = True
            self._announce(self.host.status.device)
        for sample in self._thinning.due(samples):
            self._states.append(state(sample))
            self._has_news.set()

    def note(self, status: ServiceStatus) -> None:
        """Publish the link periodically and when it changes, and a new device."""
        self._check_connection()
        now_s = asyncio.get_running_loop().time()
        if self._was_open != status.link.is_open or now_s >= self._link_due_s:
            self._was_open, self._link_due_s = status.link.is_open, now_s + LINK_EVERY_S
            self._retain(self._topics.link, self._link(status))
        if self._announced != status.device:
            self._announce(status.device)

    def counts(self) -> tuple[int, int]:
        """States."""
        return self._sent, self._states.dropped

    async def close(self) -> None:
        """Say that we go, and disconnect."""
        is_connected = bool(self._tasks) and not any(task.done() for task in self._tasks)
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)
        if self._client is not None:
            from aiomqtt import MqttError

            with contextlib.suppress(MqttError):  # it is gone already
                if is_connected:
                    await self._client.publish(
                        self._topics.availability, OFFLINE, AT_LEAST_ONCE, retain=True, timeout=FAREWELL_S
                    )
                await self._client.__aexit__(None, None, None)
        if self._guard is not None:
            self._guard.close()

    async def _publish(self, client: "aiomqtt.Client") -> None:
        while True:
            await self._has_news.wait()
            self._has_news.clear()
            while self._retained or self._states:
                if self._retained:
                    topic = next(iter(self._retained))
                    await client.publish(topic, self._retained.pop(topic), AT_LEAST_ONCE, retain=True)
                else:
                    message, count = self._states.pop()
                    await client.publish(self._topics.state, message)
                    self._sent += count

    async def _listen(self, client: "aiomqtt.Client") -> None:
        """Listen until the broker is gone; announce the entities when Home Assistant starts."""
        async for message in client.messages:
            if message.payload == BIRTH.encode():
                self._announce(self.host.status.device)

    def _check_connection(self) -> None:
        for task in self._tasks:
            if task.done() and not task.cancelled():
                problem = self._guard.problem if self._guard is not None else ""
                raise OutputError(problem or f"the connection to the broker is lost: {_reason(task.exception())}")

    def _announce(self, device: DeviceStatus) -> None:
        self._announced = device
        if self.options.discovery:
            document = discovery(self._name, self._topics, device, __version__, has_axes=self._has_axes)
            self._retain(self._config_topic, document)

    def _retain(self, topic: str, text: str) -> None:
        self._retained[topic] = text
        self._has_news.set()

    def _link(self, status: ServiceStatus) -> str:
        worst = health(status)[0].says
        return json.dumps({**asdict(status.link), "health": worst[:255], "states_dropped": self._states.dropped})

    def _check_names(self) -> None:
        if not re.fullmatch(r"[a-zA-Z0-9_-]+", self._name):
            raise OutputError(f"id={self._name!r} may have only letters, digits, _ and -")
        for option, text in (("topic", self.options.topic), ("discovery", self.options.discovery)):
            if re.search(r"[+#\x00]", text):
                raise OutputError(f"{option}={text!r} may have no +, # or zero byte")

    def _password(self) -> str:
        if not self.options.password_file:
            return self.options.password.reveal()
        try:
            return (
                read_ordinary(Path(self.options.password_file), LONGEST_PASSWORD_BYTES).content.decode().rstrip("\r\n")
            )
        except (OSError, UnreadableError, UnicodeDecodeError) as error:
            raise OutputError(f"cannot read password_file={self.options.password_file}: {error}") from error

    def _tls(self) -> ssl.SSLContext | None:
        if not self.options.tls:
            return None
        try:
            for path in filter(None, (self.options.ca, self.options.certificate, self.options.key)):
                read_ordinary(Path(path), LONGEST_PEM_BYTES)  # a pipe would block the loop of all outputs
            context = ssl.create_default_context(cafile=self.options.ca or None)
            if self.options.certificate:
                context.load_cert_chain(self.options.certificate, self.options.key or None)
        except (OSError, ValueError, UnreadableError) as error:  # ssl.SSLError is an OSError
            raise OutputError(f"cannot use the certificates of ca, certificate and key: {error}") from error
        return context


def state(sample: Corrected) -> bytes:
    """A sample as JSON with all fields of its device, null for unknown values."""
    names = [name for name, field in CHOICES.items() if field.value(sample) is not None]
    return json.dumps(dict.fromkeys(names) | present_fields(sample)).encode()


def _reason(error: BaseException | None) -> str:
    """Text of an error, with its cause."""
    return f"{error} ({error.__cause__})" if error and error.__cause__ else str(error)


def _silent() -> logging.Logger:
    """Silent logger for the library; errors are raised and logged by the hub."""
    logger = logging.getLogger("gyrodrift.outputs.mqtt")
    logger.setLevel(logging.CRITICAL)
    return logger
