"""Faults of the sources of samples: autopilots, Linux IIO, CAN, MQTT, rosbridge and Bluetooth."""

from mutate.fault import Fault

SOURCES, TESTS = "gyrodrift/link/sources", "tests/link/sources"
MAVLINK_TESTS = (f"{TESTS}/test_mavlink.py",)
IIO_TESTS = (f"{TESTS}/test_iio.py",)
CAN_TESTS = (f"{TESTS}/test_can.py",)
MQTT_TESTS = (f"{TESTS}/test_mqtt_source.py",)
ROS_TESTS = (f"{TESTS}/test_rosbridge_source.py",)

FAULTS = (
    Fault(
        "sources/mavlink-z-points-down",
        f"{SOURCES}/mavlink_decoder.py",
        "    inertial = upside_down(inertial)\n",
        "",
        "Yaw of an autopilot turns the wrong way.",
        MAVLINK_TESTS,
    ),
    Fault(
        "sources/mavlink-first-message-wins",
        f"{SOURCES}/mavlink_decoder.py",
        "(stream[2:] == best[2:] and stream < best)",
        "(stream[2:] == best[2:] and stream > best)",
        "The worst of several sensors is read.",
        MAVLINK_TESTS,
    ),
    Fault(
        "sources/mavlink-vehicles-are-mixed",
        f"{SOURCES}/mavlink_decoder.py",
        "        if measured is not None and measured[0] == self._chosen:\n",
        "        if measured is not None and self._chosen is not None:\n",
        "The samples of two vehicles become one stream.",
        MAVLINK_TESTS,
    ),
    Fault(
        "sources/mavlink-raw-imu-is-guessed",
        f"{SOURCES}/mavlink_decoder.py",
        "        if self._choice.raw_dps_per_lsb is None:\n            return 0, None\n",
        "        self._choice = ImuChoice(raw_dps_per_lsb=DPS_PER_MRADS)\n",
        "Counts of an unknown unit become deg/s.",
        MAVLINK_TESTS,
    ),
    Fault(
        "sources/iio-elements-are-not-aligned",
        f"{SOURCES}/iio_buffer.py",
        "        position = -(-end // size) * size\n",
        "        position = end\n",
        "The timestamp is read from the padding before it.",
        IIO_TESTS,
    ),
    Fault(
        "sources/iio-offset-after-scale",
        f"{SOURCES}/iio_readings.py",
        "        return (count + self.offset) * self.scale\n",
        "        return count * self.scale + self.offset\n",
        "A temperature is wrong by thousands of degrees.",
        IIO_TESTS,
    ),
    Fault(
        "sources/iio-mirror-is-a-rotation",
        f"{SOURCES}/iio_readings.py",
        "max(products) <= ROTATION_TOLERANCE and determinant > 0.0",
        "max(products) <= ROTATION_TOLERANCE",
        "A mirrored mount matrix changes the sign of yaw.",
        IIO_TESTS,
    ),
    Fault(
        "sources/iio-buffer-stays-on",
        f"{SOURCES}/iio_buffer.py",
        '        self._device.try_to_write("buffer/enable", "0")\n        with suppress',
        "        with suppress",
        "The chip interrupts the processor after the end of the service.",
        IIO_TESTS,
    ),
    Fault(
        "sources/can-first-measurement-is-kept",
        f"{SOURCES}/can_frames.py",
        "        return None if is_first else self._measured(values)\n",
        "        return self._measured(values)\n",
        "A part of a measurement is a sample.",
        CAN_TESTS,
    ),
    Fault(
        "sources/can-accelerations-of-the-sample-before",
        f"{SOURCES}/can_frames.py",
        "number & ~EXTENDED <= self._last_id",
        "number in self._ids",
        "Accelerations belong to another rate.",
        CAN_TESTS,
    ),
    Fault(
        "sources/can-unit-is-guessed",
        f"{SOURCES}/can_dbc.py",
        "    name = options.get(option, stated)\n",
        "    name = options.get(option, stated or next(iter(units)))\n",
        "A signal without a unit is read as deg/s.",
        CAN_TESTS,
    ),
    Fault(
        "sources/mqtt-retained-is-a-sample",
        f"{SOURCES}/mqtt.py",
        "if message.payload and not message.retain and",
        "if message.payload and",
        "A message of yesterday is the first sample.",
        MQTT_TESTS,
    ),
    Fault(
        "sources/mqtt-password-in-an-address",
        f"{SOURCES}/mqtt.py",
        '    if ":" in user:\n',
        '    if "\\0" in user:\n',
        "All users of the machine can read a password.",
        MQTT_TESTS,
    ),
    Fault(
        "sources/mqtt-broker-is-never-asked",
        f"{SOURCES}/mqtt.py",
        " and not self._client.loop_misc()",
        "",
        "The broker ends a connection on which nothing is published.",
        MQTT_TESTS,
    ),
    Fault(
        "sources/ros-covariance-is-ignored",
        f"{SOURCES}/rosbridge.py",
        "covariance[:1] == [MISSING]",
        "covariance[:1] == []",
        "A rate that a driver does not measure is 0.",
        ROS_TESTS,
    ),
    Fault(
        "sources/ros-stamp-in-nanoseconds",
        f"{SOURCES}/rosbridge.py",
        "nanoseconds // 1000)",
        "nanoseconds)",
        "Time runs in steps of seconds.",
        ROS_TESTS,
    ),
    Fault(
        "sources/ble-lost-device-is-not-noticed",
        f"{SOURCES}/ble.py",
        "        if not content and self._inbox.is_over:\n",
        "        if not content and self._inbox.is_over and False:\n",
        "A device that comes back is never read again.",
        (f"{TESTS}/test_ble.py",),
    ),
)
