"""Search for `--port auto`: the only port with a gyro."""

from collections.abc import Sequence
from dataclasses import replace

from gyrodrift.link.listening import HeardPort, Speech, listen_at
from gyrodrift.link.options import EventHandler, LinkOptions
from gyrodrift.link.serial_port import SerialPort
from gyrodrift.link.sources.source import SourcePort
from gyrodrift.values.errors import PortMissingError, UsageError


def find_gyro(
    ports: Sequence[SerialPort],
    options: LinkOptions,
    on_event: EventHandler,
    simulated: Sequence[SerialPort] = (),
    devices: Sequence[SerialPort] = (),
) -> tuple[LinkOptions, SourcePort]:
    """Options of the link to the only gyro, and its open port.

    devices
        Devices of other sources, which are searched if no serial port has a gyro.
    simulated
        Simulated devices, which are never searched; the error lists them if no gyro is found.

    Raises
    ------
    PortMissingError
        No port is plugged in, or there is no gyro at any port.
    UsageError
        There are several gyros, or `--send` would reach several ports.
    """
    if not ports and devices:
        ports, devices = devices, ()
    if not ports:
        says = "--port auto: no serial port is plugged in; plug the gyro in, or name its port with --port"
        raise PortMissingError("\n".join([says, *_left_out(simulated)]))
    if options.send and len(ports) > 1:
        names = ", ".join(port.name for port in ports)
        raise UsageError(f"--port auto: --send would reach {names}; name one of them with --port")
    on_event("port_search", ports=len(ports))
    heard = listen_at(ports, options, keeps_speakers=True)
    if devices and not any(port.speech for port in heard):
        heard += listen_at(devices, replace(options, baud=None), keeps_speakers=True)
    speakers = [(port.port.name, port.speech, port.open_port) for port in heard if port.speech and port.open_port]
    if len(speakers) != 1:
        for _, _, open_port in speakers:
            open_port.close()
        kind = UsageError if speakers else PortMissingError
        lines = [_listing(heard, len(speakers)), *_left_out(() if speakers else simulated)]
        raise kind("\n".join(lines))
    name, speech, open_port = speakers[0]
    on_event("port_found", port=name, protocol=speech.protocol, baud=speech.baud, rate_hz=_rounded(speech.rate_hz))
    return replace(options, port=name, baud=speech.baud or None, protocol=speech.protocol), open_port


def speech_text(speech: Speech) -> str:
    """Protocol, rate, baud rate and id of a device."""
    rate = "" if speech.rate_hz is None else f" at {speech.rate_hz:.4g} Hz"
    device = "" if speech.device_id is None else f", device {speech.device_id}"
    baud = f", {speech.baud} baud" if speech.baud else ""
    return f"{speech.protocol}{rate}{baud}{device}"


def _listing(heard: Sequence[HeardPort], speakers: int) -> str:
    count = "no gyro found" if not speakers else f"{speakers} gyros found"
    advice = "plug one in, or name its port with --port" if not speakers else "name one of them with --port"
    lines = [f"{port.port.name}: {speech_text(port.speech) if port.speech else port.reason}" for port in heard]
    return "\n".join([f"--port auto: {count}; {advice}", *lines])


def _left_out(simulated: Sequence[SerialPort]) -> list[str]:
    return [f"{port.name}: simulated device, which --port auto ignores" for port in simulated]


def _rounded(rate_hz: float | None) -> float | None:
    return None if rate_hz is None else round(rate_hz, 1)
