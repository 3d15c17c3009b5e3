"""rosbridge v2: `sensor_msgs/Imu` as JSON over WebSocket, for roslibjs, roslibpy and other clients."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

from annotated_types import Gt, Le, MaxLen, MinLen

from gyrodrift.outputs.net.servers import ServerOutput
from gyrodrift.outputs.net.websocket import WebSocketServer
from gyrodrift.outputs.options import LOOPBACK, About, Host, Port, Rate
from gyrodrift.outputs.output import OutputHost
from gyrodrift.outputs.ros_messages import IMU_TYPES, ImuMessage, RosVersion
from gyrodrift.outputs.rosbridge_session import RosbridgeSession, RosServices
from gyrodrift.outputs.thinning import Thinning
from gyrodrift.values.sample import Corrected


@dataclass(frozen=True, slots=True)
class RosbridgeOptions:
    """Address, rate and names."""

    host: Annotated[Host, About("address to listen on")] = LOOPBACK
    port: Annotated[Port, About("port to listen on; 0 takes a free one")] = 9090
    rate_hz: Annotated[Rate, About("at most this many messages a second of device time")] = None
    topic: Annotated[str, MinLen(1), MaxLen(200), About("topic of the Imu messages")] = "/imu/data"
    frame_id: Annotated[str, MaxLen(200), About("frame that the sensor is fixed to")] = "imu_link"
    ros: Annotated[RosVersion, About("version of ROS for header and type name")] = "ros2"
    rate_sigma_dps: Annotated[
        Annotated[float, Gt(0.0), Le(1000.0)] | None,
        About("standard deviation of one measured rate, deg/s; without it the covariance of the rate is unknown"),
    ] = None
    accel_sigma_mps2: Annotated[
        Annotated[float, Gt(0.0), Le(1000.0)] | None,
        About("standard deviation of one acceleration, m/s²; without it their covariance is unknown"),
    ] = None


class RosbridgeOutput(ServerOutput[RosbridgeOptions, WebSocketServer[RosbridgeSession]]):
    """One topic, and the services that clients call before they subscribe."""

    options_type = RosbridgeOptions

    def __init__(self, options: RosbridgeOptions, host: OutputHost) -> None:
        super().__init__(options, host)
        services = RosServices(f"/{options.topic.strip('/')}", IMU_TYPES[options.ros], options.ros)
        self.server = WebSocketServer(lambda client: RosbridgeSession(client, services), host.log)
        sigmas = options.rate_sigma_dps, options.accel_sigma_mps2
        self._message = ImuMessage(json.dumps(options.frame_id), options.ros, *sigmas)
        self._thinning = Thinning(options.rate_hz)

    async def open(self) -> None:
        """Begin to listen."""
        self.address = await self.server.listen(self.options.host, self.options.port)

    def take(self, samples: Sequence[Corrected]) -> None:
        """Publish to subscribers; each message is encoded once."""
        subscribed = [session for session in self.server.clients.values() if session.has_subscribed]
        if not subscribed:
            return
        for corrected in self._thinning.due(samples):
            message = self._message.json(corrected)
            for session in subscribed:
                session.publish(corrected.sample.t_device_s, message)
