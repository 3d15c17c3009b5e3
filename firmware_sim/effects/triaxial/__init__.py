"""Effects of a sensor with three gyro axes and an accelerometer."""
