"""Features: named statistics of a recording, each tied to a stage of the measurement."""
