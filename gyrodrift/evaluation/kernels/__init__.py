"""Filters compiled, for many candidates at a time, with the bits of the plain ones."""
