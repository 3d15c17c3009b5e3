"""Faults of a device that sends its own yaw: on the wire, in files, and where it is compared."""

from mutate.fault import Fault

PROTOCOL = "gyrodrift/link/protocols/native.py"
WIRE_TESTS = ("tests/link/protocols/test_native_yaw.py",)
FILE_TESTS = ("tests/session/test_device_yaw.py",)
SERVICE_TESTS = ("tests/service/test_device_yaw.py",)
COMPARE_TESTS = ("tests/compare/test_on_device.py",)

FAULTS = (
    Fault(
        "device-yaw/of-any-sample",
        PROTOCOL,
        "(sample.seq, sample.t_us) != (seq, t_us)",
        "sample.seq != seq",
        "A yaw of the same counter after a restart is that of another sample.",
        WIRE_TESTS,
    ),
    Fault(
        "device-yaw/nan-accepted",
        PROTOCOL,
        "abs(yaw_deg) <= MOST_DEG and",
        "not abs(yaw_deg) > MOST_DEG and",
        "A yaw that is no number is passed on.",
        WIRE_TESTS,
    ),
    Fault(
        "device-yaw/negative-sigma",
        PROTOCOL,
        "isnan(yaw_sigma_deg) or 0.0 <= yaw_sigma_deg <= MOST_DEG",
        "isnan(yaw_sigma_deg) or yaw_sigma_deg <= MOST_DEG",
        "A negative standard deviation is passed on.",
        WIRE_TESTS,
    ),
    Fault(
        "device-yaw/every-sample-waits",
        PROTOCOL,
        "% COUNTER_WRAP >= self._stride",
        "% COUNTER_WRAP >= 0",
        "Samples without a yaw come one period late.",
        WIRE_TESTS,
    ),
    Fault(
        "device-yaw/last-sample-lost",
        PROTOCOL,
        "self.is_idle = not self._is_announced and self._held is None",
        "self.is_idle = not self._is_announced",
        "The sample that waits is lost when the device is exchanged.",
        WIRE_TESTS,
    ),
    Fault(
        "device-yaw/repair-forgets-it",
        "gyrodrift/session/mcap/read.py",
        "session.gyro_dps is not None, session.device_yaw_deg is not None",
        "session.gyro_dps is not None, False",
        "A repaired file has lost its samples or the yaw of the device.",
        FILE_TESTS,
    ),
    Fault(
        "device-yaw/sign-kept-upside-down",
        "gyrodrift/values/calibration.py",
        "device_yaw=DeviceYaw(-yaw_deg, sigma_deg, -bias_dps)",
        "device_yaw=DeviceYaw(yaw_deg, sigma_deg, bias_dps)",
        "The yaw of a device upside down turns against ours.",
        SERVICE_TESTS,
    ),
    Fault(
        "device-yaw/difference-of-turns",
        "gyrodrift/service/reference.py",
        "remainder(apart_deg - self._offset_deg, FULL_TURN_DEG)",
        "apart_deg - self._offset_deg",
        "A device that wraps its yaw differs by whole turns.",
        SERVICE_TESTS,
    ),
    Fault(
        "device-yaw/zero-of-the-device",
        "gyrodrift/compare/methods/filter_method.py",
        "device.yaw_deg - device.yaw_deg[0]",
        "device.yaw_deg",
        "The yaw since power-on is scored in place of that since the first sample.",
        COMPARE_TESTS,
    ),
)
