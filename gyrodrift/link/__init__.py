"""Timed samples from a serial port: port, decoders, clock, and the link that combines them."""
