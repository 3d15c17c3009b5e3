"""Comparisons of recordings with replays of the rig, without and with the causes: the numbers that the report draws."""
