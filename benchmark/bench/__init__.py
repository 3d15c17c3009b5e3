"""Measurements of speed, latency, memory and accuracy: `make bench`."""
