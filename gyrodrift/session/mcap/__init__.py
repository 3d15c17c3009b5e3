"""Sessions as MCAP: written so that a kill loses nothing, read in one go, repaired."""
