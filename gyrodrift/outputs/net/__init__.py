"""Servers that outputs build on: they keep slow, dead and hostile clients away from everybody else."""
