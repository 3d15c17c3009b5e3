"""Sessions as MCAP: writing that survives a kill, reading, and repair."""
