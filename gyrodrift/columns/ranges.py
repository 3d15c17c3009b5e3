"""Ranges of quantities in lines of a device and in tables."""

TEMPERATURES_C = (-55.0, 150.0)
"""Military temperature range up to the largest junction temperature; outside, a temperature is in counts."""

MEDIAN_ACCEL_MPS2 = (7.0, 13.0)
"""Range of the median length of accelerations in m/s²; counts, g and other quantities are outside."""
