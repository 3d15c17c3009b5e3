"""Calibration of a gyro: rest, temperature run, and whole turns against a mark; samples in, values out."""
