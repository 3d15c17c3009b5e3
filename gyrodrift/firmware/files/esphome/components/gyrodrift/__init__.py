"""Yaw of a gyro on I2C, filtered by gyrodrift.h; the sensors are in `sensor.py`."""
