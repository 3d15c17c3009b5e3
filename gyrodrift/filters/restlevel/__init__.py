"""Restlevel: a Gaussian-sum filter over which constant-rate segments were rests, and so zero-velocity updates."""
