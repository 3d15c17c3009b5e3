"""Topics on the server of the robot, through ntcore: a client that looks for the robot and reconnects by itself.

The server of ntcore lets any of its clients publish to any topic. That cannot be kept out from here; other publishers
of our topics are found and told. ntcore sends from threads of its own.
"""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from gyrodrift.logger import FilteringBoundLogger
from gyrodrift.outputs.net.addresses import shown
from gyrodrift.outputs.net.names import shown_name
from gyrodrift.outputs.status import ClientStatus

if TYPE_CHECKING:
    import ntcore

IDENTITY = "gyrodrift"
PERIOD_S = 0.01
US_PER_S = 1e6


class RobotTables:
    """Topics that are published to the robot.

    Parameters
    ----------
    robot
        Address, or team number.
    topics
        Type of each topic, by its full name.
    """

    def __init__(self, robot: str, port: int, topics: Mapping[str, str], log: FilteringBoundLogger) -> None:
        self._robot, self._port = robot, port
        self._topics = topics
        self._log = log
        self._instance: ntcore.NetworkTableInstance | None = None
        self._publishers: dict[str, Any] = {}
        self._watchers: dict[str, ntcore.RawSubscriber] = {}
        self._strangers: dict[str, list[str]] = {}

    async def open(self) -> str:
        """Begin to look for the robot."""
        import ntcore

        instance = self._instance = ntcore.NetworkTableInstance.create()
        options = ntcore.PubSubOptions(periodic=PERIOD_S)
        for name, kind in self._topics.items():
            topic = instance.getDoubleTopic(name) if kind == "double" else instance.getBooleanTopic(name)
            self._publishers[name] = topic.publish(options)
            self._watchers[name] = instance.getRawTopic(f"$pub${name}").subscribe("msgpack", b"")
        if self._robot.isdecimal():
            instance.setServerTeam(int(self._robot), self._port)
        else:
            instance.setServer(self._robot, self._port)
        instance.startClient4(IDENTITY)
        self._log.warning("topics_are_open", hint="the robot's server lets each of its clients publish to our topics")
        return f"team {self._robot}" if self._robot.isdecimal() else shown(self._robot, self._port)

    def now_s(self) -> float:
        """The clock of ntcore, s."""
        import ntcore

        return float(ntcore._now()) / US_PER_S  # noqa: SLF001 - the clock of NetworkTables has no other name in Python

    def server_offset_s(self) -> float:
        """As ntcore measures it; 0 before."""
        offset_us = self._instance.getServerTimeOffset() if self._instance is not None else None
        return (offset_us or 0) / US_PER_S

    def publish(self, values: Mapping[str, float | bool], stamp_us: int | None = None) -> None:
        """Publish values; a client that is slow gets the newest of each topic."""
        for name, value in values.items():
            if name in self._publishers:
                self._publishers[name].set(value, stamp_us or 0)  # ntcore takes 0 for now

    def check(self) -> str:
        """Who else publishes to our topics; told in the log when they come and when they go."""
        found = {name: strangers for name, watcher in self._watchers.items() if (strangers := _strangers(watcher))}
        for name in found.keys() - self._strangers.keys():
            self._log.warning("topic_forged", topic=name, clients=found[name], hint="readers may see their values")
        for name in self._strangers.keys() - found.keys():
            self._log.info("topic_ours_again", topic=name)
        self._strangers = found
        names = sorted({each for strangers in found.values() for each in strangers})
        return f"values are forged on the robot's server, by {', '.join(names[:5])}" if names else ""

    def clients(self) -> Sequence[ClientStatus]:
        """The robot, where it is there."""
        if self._instance is None:
            return ()
        try:
            return [
                ClientStatus(f"{shown_name(each.remote_id)} {shown(each.remote_ip, each.remote_port)}")
                for each in self._instance.getConnections()
            ]
        except UnicodeDecodeError:  # ntcore gives names as they came
            return [ClientStatus("a robot whose name is no text")]

    def dropped(self) -> int:
        """Ntcore tells nobody."""
        return 0

    async def close(self) -> None:
        """Let go of the tables."""
        if self._instance is None:
            return
        import ntcore

        for each in (*self._publishers.values(), *self._watchers.values()):
            each.close()
        self._publishers, self._watchers = {}, {}
        self._instance.stopClient()
        ntcore.NetworkTableInstance.destroy(self._instance)
        self._instance = None


def _strangers(watcher: "ntcore.RawSubscriber") -> list[str]:
    """Names of the publishers of a topic beside this service, of `$pub$TOPIC`; several services are strangers too."""
    import msgpack

    try:
        publishers = msgpack.unpackb(watcher.get(), unicode_errors="backslashreplace") if watcher.get() else []
        names = [shown_name(str(each["client"])) or "the robot itself" for each in publishers]
    except (ValueError, KeyError, TypeError, msgpack.exceptions.UnpackException):
        return []
    ours = next((each for each in (IDENTITY, *names) if each in names and each.partition("@")[0] == IDENTITY), None)
    if ours is not None:  # a server tells two clients of one name apart by @ and a number
        names.remove(ours)
    return names
