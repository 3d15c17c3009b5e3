"""Faults of the sources: network, pipes, followed files, and several gyros in one service."""

from mutate.fault import Fault

SOURCES, TESTS = "gyrodrift/link/sources", "tests/link/sources"
NETWORK_TESTS = (f"{TESTS}/test_network.py",)

FAULTS = (
    Fault(
        "sources/udp-listens-to-all",
        f"{SOURCES}/udp.py",
        'LOOPBACK = "127.0.0.1"',
        'LOOPBACK = "0.0.0.0"',
        "Everybody on the network can send rates.",
        NETWORK_TESTS,
    ),
    Fault(
        "sources/udp-mixes-senders",
        f"{SOURCES}/udp.py",
        "            if self._followed in (None, sender):\n",
        "            if True:\n",
        "The samples of two gyros become one stream.",
        NETWORK_TESTS,
    ),
    Fault(
        "sources/reconnect-holds-the-loop",
        f"{SOURCES}/opening.py",
        "        if self._thread.is_alive():\n            return None\n",
        "        self._thread.join()\n",
        "A name server that does not answer stops all gyros of a service.",
        (f"{TESTS}/test_opening.py",),
    ),
    Fault(
        "sources/telnet-keeps-doubled-255",
        f"{SOURCES}/rfc2217.py",
        'parts.append(match["doubled"])',
        'parts.append(2 * match["doubled"])',
        "A byte 255 arrives twice through RFC 2217.",
        (f"{TESTS}/test_telnet.py",),
    ),
    Fault(
        "sources/last-line-is-lost",
        f"{SOURCES}/stdin.py",
        '            return b"\\n"\n',
        '            return b""\n',
        "The last line of a file without a line end is no sample.",
        (f"{TESTS}/test_standard_input.py",),
    ),
    Fault(
        "sources/a-failure-ends-all",
        "gyrodrift/service/several.py",
        "            self._failed += 1\n",
        "            raise\n",
        "One gyro that is silent stops the others.",
        ("tests/service/test_several.py",),
    ),
)
