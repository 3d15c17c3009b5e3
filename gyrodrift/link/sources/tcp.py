"""Source `tcp://HOST:PORT`: the bytes of a TCP server, such as an ESP32 or ser2net."""

from dataclasses import replace

from gyrodrift.link.sources.sockets import SocketPort, connected
from gyrodrift.link.sources.source import ByteSource, SourceAddress


def open_tcp(address: SourceAddress) -> SocketPort:
    """Connect to a server."""
    return SocketPort(address.text, connected(address))


TCP = ByteSource(
    "tcp",
    "tcp://HOST:PORT",
    "bytes of a TCP server, such as an ESP32 or ser2net",
    open_tcp,
    silence="the server accepted the connection; check that the device behind it is on and sends",
)
SOCKET = replace(TCP, scheme="socket", title="socket://HOST:PORT", about="the same as tcp, in the words of pyserial")
