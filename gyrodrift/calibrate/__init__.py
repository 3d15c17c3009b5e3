"""Calibrating a gyro by hand: rest, whole turns against a mark in both directions, warming; samples in, values out."""
