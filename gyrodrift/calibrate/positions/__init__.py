"""Calibration of three axes: rests on six sides against gravity, and whole turns with each axis up."""
