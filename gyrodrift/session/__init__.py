"""Recorded sessions: arrays in, arrays out; one file a format."""
