"""MCAP sessions of other programs: reading and writing."""
