"""The filter that a device runs itself, as a method: its yaw and sigma as recorded."""

from dataclasses import replace

from gyrodrift.compare.methods.method import Method, Params
from gyrodrift.evaluation.auxiliary import DeviceColumns
from gyrodrift.values.arrays import Floats


def missing_yaw(_t_s: Floats, _rate_dps: Floats, _params: Params) -> Floats:
    """No yaw for a device without a filter."""
    raise ValueError("the method needs the yaw of the device's own filter")


def recorded(device: DeviceColumns) -> Method:
    """The method for the columns of a session."""
    return replace(
        ON_DEVICE,
        run=lambda _t_s, _rate_dps, _params: device.yaw_deg - device.yaw_deg[0],
        sigma=lambda _t_s, _rate_dps, _params: device.yaw_sigma_deg,
    )


ON_DEVICE = Method(
    "on-device",
    "on-device",
    missing_yaw,
    about="The filter that the device runs itself: its yaw and sigma as recorded, held where a sample has none.",
    needs_device_yaw=True,
    with_device_yaw=recorded,
    color="two",
    dash="--",
)
