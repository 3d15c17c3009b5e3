"""Checks of the units of a stream."""
