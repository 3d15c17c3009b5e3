"""Topics on the server of the robot, through ntcore, which reconnects by itself.

The server of ntcore lets any client publish to any topic. A client cannot prevent that, but it finds and reports other
publishers of its topics. ntcore sends from threads of its own.
"""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from gyrodrift.io.logger import FilteringBoundLogger
from gyrodrift.outputs.net.addresses import shown, shown_name
from gyrodrift.outputs.networktables_server import TopicValue
from gyrodrift.outputs.status import ClientStatus
from gyrodrift.values.constants import US_PER_S

if TYPE_CHECKING:
    import ntcore

IDENTITY = "gyrodrift"
PERIOD_S = 0.01


class RobotTables:
    """Topics on the robot.

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
        self._foreign: dict[str, list[str]] = {}

    async def open(self) -> str:
        """Begin to connect to the robot."""
        import ntcore

        instance = self._instance = ntcore.NetworkTableInstance.create()
        for name, kind in self._topics.items():
            self._open_topic(instance, name, kind)
        if self._robot.isdecimal():
            instance.setServerTeam(int(self._robot), self._port)
        else:
            instance.setServer(self._robot, self._port)
        instance.startClient4(IDENTITY)
        self._log.warning("topics_are_open", hint="the robot's server lets each of its clients publish to our topics")
        return f"team {self._robot}" if self._robot.isdecimal() else shown(self._robot, self._port)

    def add(self, topics: Mapping[str, str], schemas: Mapping[str, str]) -> None:
        """Publish further topics, and the layouts of their types."""
        if self._instance is None:
            return
        for kind, schema in schemas.items():
            self._instance.addSchema(kind, "structschema", schema)
        for name, kind in topics.items():
            self._open_topic(self._instance, name, kind)

    def _open_topic(self, instance: "ntcore.NetworkTableInstance", name: str, kind: str) -> None:
        import ntcore

        options = ntcore.PubSubOptions(periodic=PERIOD_S)
        if kind == "double":
            self._publishers[name] = instance.getDoubleTopic(name).publish(options)
        elif kind == "boolean":
            self._publishers[name] = instance.getBooleanTopic(name).publish(options)
        else:
            self._publishers[name] = instance.getRawTopic(name).publish(kind, options)
        self._watchers[name] = instance.getRawTopic(f"$pub${name}").subscribe("msgpack", b"")

    def now_s(self) -> float:
        """The clock of ntcore, s."""
        import ntcore

        return float(ntcore._now()) / US_PER_S  # noqa: SLF001 - no public name

    def server_offset_s(self) -> float:
        """Offset measured by ntcore; 0 before."""
        offset_us = self._instance.getServerTimeOffset() if self._instance is not None else None
        return (offset_us or 0) / US_PER_S

    def publish(self, values: Mapping[str, TopicValue], stamp_us: int | None = None) -> None:
        """Publish values; a slow client gets the newest value of each topic."""
        for name, value in values.items():
            if name in self._publishers:
                self._publishers[name].set(value, stamp_us or 0)  # ntcore takes 0 for now

    def check(self) -> str:
        """Other publishers of the topics; they are logged when they come and go."""
        foreign = {name: clients for name, watcher in self._watchers.items() if (clients := _foreign_names(watcher))}
        for name in foreign.keys() - self._foreign.keys():
            self._log.warning("topic_forged", topic=name, clients=foreign[name], hint="readers may see their values")
        for name in self._foreign.keys() - foreign.keys():
            self._log.info("topic_ours_again", topic=name)
        self._foreign = foreign
        names = sorted({client for clients in foreign.values() for client in clients})
        return f"values are forged on the robot's server, by {', '.join(names[:5])}" if names else ""

    def clients(self) -> Sequence[ClientStatus]:
        """The robot, if it is connected."""
        if self._instance is None:
            return ()
        try:
            return [
                ClientStatus(f"{shown_name(peer.remote_id)} {shown(peer.remote_ip, peer.remote_port)}")
                for peer in self._instance.getConnections()
            ]
        except UnicodeDecodeError:  # ntcore does not check names
            return [ClientStatus("a robot whose name is no text")]

    def dropped(self) -> int:
        """0: ntcore does not count them."""
        return 0

    async def close(self) -> None:
        """Close the tables."""
        if self._instance is None:
            return
        import ntcore

        for handle in (*self._publishers.values(), *self._watchers.values()):
            handle.close()
        self._publishers, self._watchers = {}, {}
        self._instance.stopClient()
        ntcore.NetworkTableInstance.destroy(self._instance)
        self._instance = None


def _foreign_names(watcher: "ntcore.RawSubscriber") -> list[str]:
    """Names of other publishers of a topic, from `$pub$TOPIC`; another gyrodrift counts, too."""
    import msgpack

    try:
        publishers = msgpack.unpackb(watcher.get(), unicode_errors="backslashreplace") if watcher.get() else []
        names = [shown_name(str(entry["client"])) or "the robot itself" for entry in publishers]
    except (ValueError, KeyError, TypeError, msgpack.exceptions.UnpackException):
        return []
    ours = next((entry for entry in (IDENTITY, *names) if entry in names and entry.partition("@")[0] == IDENTITY), None)
    if ours is not None:  # a server tells two clients of one name apart by @ and a number
        names.remove(ours)
    return names
