"""MAVLink 2: a heartbeat, and attitude with its covariance as ODOMETRY or ATTITUDE, for autopilots and ground stations.

The axes of MAVLink are forward, right, down, so yaw is clockwise positive. Elsewhere in gyrodrift it is
counter-clockwise. A device with one axis is level.
Definitions: https://mavlink.io/en/messages/common.html#ODOMETRY, #ATTITUDE_QUATERNION, #ATTITUDE_QUATERNION_COV and
#HEARTBEAT.
"""

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isnan, nan
from typing import TYPE_CHECKING, Annotated, Any, Literal

from annotated_types import Ge, Gt, Le, MinLen

from gyrodrift.outputs.device_frame import UNTURNED, DeviceFrame, FrdReference, FrdSample, frd_sample
from gyrodrift.outputs.net.addresses import DatagramSender
from gyrodrift.outputs.net.pty import SerialLine
from gyrodrift.outputs.options import LOOPBACK, About, Host, Port
from gyrodrift.outputs.output import Output, OutputHost
from gyrodrift.outputs.status import ServiceStatus
from gyrodrift.outputs.thinning import Thinning
from gyrodrift.values.sample import Corrected

if TYPE_CHECKING:
    from pymavlink.dialects.v20.common import MAVLink_message

UNKNOWN_VARIANCE = 1e6
"""Variance of unknown positions (m²), velocities (m²/s²) and rates (rad²/s²)."""

SILENT_S = 2.0
"""Time without a sample after which the heartbeat has an unknown state, s."""

ROLL, PITCH, YAW = 15, 18, 20
"""Indices of the variances of angles, and of their rates, in the upper triangle of a 6×6 covariance, by rows."""

POSITION = (0, 6, 11)
"""Indices of the variances of position, and of velocity."""

JUMPS = {
    "frd": frozenset({"yaw_zeroed", "yaw_corrected", "device_reset", "link_restored"}),
    "ned": frozenset({"heading_set", "yaw_corrected", "device_reset", "link_restored"}),
}
"""Events that make yaw of a frame jump."""


@dataclass(frozen=True, slots=True)
class MavlinkOptions:
    """Receiver, message, rate and ids."""

    host: Annotated[Host, About("receiver: a name, an address, or a broadcast address")] = LOOPBACK
    port: Annotated[Port, About("UDP port of the receiver")] = 14550
    device: Annotated[
        Annotated[str, MinLen(1)] | None, About("serial line or pty to write on, in place of UDP: /dev/ttyAMA0")
    ] = None
    baud: Annotated[int, Gt(0), Le(4_000_000), About("of the serial line")] = 57600
    rate_hz: Annotated[
        float, Ge(4.0), Le(1000.0), About("at most this many messages a second of device time; autopilots ask for 4")
    ] = 20.0
    message: Annotated[Literal["odometry", "attitude"], About("ODOMETRY, or ATTITUDE with ATTITUDE_QUATERNION_COV")] = (
        "odometry"
    )
    frame: Annotated[FrdReference, About("yaw from the start of the service (frd), or heading from north (ned)")] = (
        "frd"
    )
    tilt_sigma_deg: Annotated[
        float,
        Gt(0.0),
        Le(90.0),
        About("standard deviation of roll and pitch of a device with one axis, which are 0, deg"),
    ] = 5.0
    system: Annotated[int, Ge(1), Le(255), About("system id, that of the vehicle")] = 1
    component: Annotated[int, Ge(1), Le(255), About("component id; 200 is an IMU")] = 200


class MavlinkOutput(Output[MavlinkOptions]):
    """Sends a message for each sample that is due, and a heartbeat once a second."""

    options_type = MavlinkOptions

    def __init__(self, options: MavlinkOptions, host: OutputHost) -> None:
        super().__init__(options, host)
        self._to: DatagramSender | SerialLine = DatagramSender()
        self._thinning = Thinning(options.rate_hz)
        self._mount = UNTURNED
        self._has_warned = False
        self._resets = 0

    async def open(self) -> None:
        """Resolve the receiver, or open the serial line."""
        from pymavlink.dialects.v20 import common

        self._common = common
        self._resets = int(time.time()) % 256  # it differs after a restart, when yaw begins at 0
        self._link = common.MAVLink(None, self.options.system, self.options.component)
        if self.options.device is None:
            self._to = sender = DatagramSender()
            self.address = await sender.open(self.options.host, self.options.port)
        else:
            self._to = line = SerialLine()
            line.open(self.options.device, self.options.baud)
            self.address = self.options.device

    def take(self, samples: Sequence[Corrected]) -> None:
        """Send the samples that are due."""
        for sample in self._thinning.due(samples):
            values = frd_sample(sample, self.options.frame, self.options.tilt_sigma_deg, self._mount)
            if isnan(values.yaw_rad):
                self._warn_of_missing_heading()
            elif self.options.message == "odometry":
                self._send(self._odometry(sample, values))
            else:
                self._send_attitude(sample, values)

    def hear(self, event: str, fields: Mapping[str, Any]) -> None:  # noqa: ARG002 - no field is needed
        """Count the jumps of yaw."""
        if event in JUMPS[self.options.frame]:
            self._resets = (self._resets + 1) % 256

    def note(self, status: ServiceStatus) -> None:
        """Send the heartbeat."""
        self._mount = DeviceFrame.of(status.config.mount)
        common = self._common
        is_alive = status.link.is_open and status.link.silent_s < SILENT_S
        state = common.MAV_STATE_ACTIVE if is_alive else common.MAV_STATE_UNINIT
        kind, autopilot = common.MAV_TYPE_IMU, common.MAV_AUTOPILOT_INVALID
        self._send(common.MAVLink_heartbeat_message(kind, autopilot, 0, 0, state, 3))

    def counts(self) -> tuple[int, int]:
        """Messages sent and dropped."""
        return self._to.sent, self._to.dropped

    async def close(self) -> None:
        """Close the socket or the line."""
        self._to.close()

    def _send(self, message: "MAVLink_message") -> None:
        content = message.pack(self._link)
        self._link.seq = (self._link.seq + 1) % 256
        self._to.send(content)

    def _odometry(self, sample: Corrected, values: FrdSample) -> "MAVLink_message":
        common = self._common
        is_ned = self.options.frame == "ned"
        has_sigma = not isnan(values.yaw_variance_rad2)
        roll_speed, pitch_speed, yaw_speed = values.rates_rad_s
        rate_variance = values.rate_variance_rad2_s2
        return common.MAVLink_odometry_message(
            time_usec=round(sample.sample.t_host_s * 1e6),
            frame_id=common.MAV_FRAME_LOCAL_NED if is_ned else common.MAV_FRAME_LOCAL_FRD,
            child_frame_id=common.MAV_FRAME_BODY_FRD,
            **dict.fromkeys(("x", "y", "z", "vx", "vy", "vz"), 0.0),
            q=values.quaternion,
            rollspeed=roll_speed,
            pitchspeed=pitch_speed,
            yawspeed=yaw_speed,
            pose_covariance=_triangle(values.tilt_variance_rad2, values.yaw_variance_rad2),
            velocity_covariance=_triangle(rate_variance if values.has_axes else UNKNOWN_VARIANCE, rate_variance),
            reset_counter=self._resets,
            estimator_type=common.MAV_ESTIMATOR_TYPE_UNKNOWN if has_sigma else common.MAV_ESTIMATOR_TYPE_NAIVE,
            quality=0 if isnan(sample.confidence) else max(1, round(100.0 * sample.confidence)),
        )

    def _send_attitude(self, sample: Corrected, values: FrdSample) -> None:
        common, rates = self._common, values.rates_rad_s
        boot_ms = round(sample.sample.t_device_s * 1e3) % (1 << 32)
        angles = values.roll_rad, values.pitch_rad, values.yaw_rad
        self._send(common.MAVLink_attitude_message(boot_ms, *angles, *rates))
        if values.has_axes:
            self._send(common.MAVLink_attitude_quaternion_message(boot_ms, *values.quaternion, *rates))
        self._send(self._attitude_covariance(sample, values))

    def _attitude_covariance(self, sample: Corrected, values: FrdSample) -> "MAVLink_message":
        tilt, yaw = values.tilt_variance_rad2, values.yaw_variance_rad2
        covariance = (nan,) * 9 if isnan(yaw) else (tilt, 0.0, 0.0, 0.0, tilt, 0.0, 0.0, 0.0, yaw)
        time_us = round(sample.sample.t_host_s * 1e6)
        return self._common.MAVLink_attitude_quaternion_cov_message(
            time_us, values.quaternion, *values.rates_rad_s, covariance
        )

    def _warn_of_missing_heading(self) -> None:
        if not self._has_warned:
            self._has_warned = True
            self.host.log.warning("mavlink_waits_for_heading", advice="set one with gyrodrift ctl PATH heading DEG")


def _triangle(tilt_variance: float, yaw_variance: float) -> tuple[float, ...]:
    """Upper triangle of a 6×6 covariance, by rows; all NaN (unknown) if the variance of yaw is."""
    if isnan(yaw_variance):
        return (nan,) * 21
    variances = {ROLL: tilt_variance, PITCH: tilt_variance, YAW: yaw_variance} | dict.fromkeys(
        POSITION, UNKNOWN_VARIANCE
    )
    return tuple(variances.get(index, 0.0) for index in range(21))
