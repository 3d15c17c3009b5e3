"""Values that pass between packages, under their public names."""

from gyrodrift.values.sample import Attitude, Corrected, DeviceYaw, Inertial, Reading, Sample

__all__ = ["Attitude", "Corrected", "DeviceYaw", "Inertial", "Reading", "Sample"]
