"""Recorded sessions as arrays; one package or file per format."""
