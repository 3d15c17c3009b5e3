"""From a serial port to timed samples: port, decoders, clock, and the link that holds them together."""
