"""gyrodrift: yaw from a low-cost gyro, with the drift taken out as it streams."""

__version__ = "0.1.0"
