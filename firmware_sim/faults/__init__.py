"""Scripted faults between a gyro and its reader, by level: measurements, frames, cable."""
