"""Whether a stream's numbers have the units that they are taken for."""
