"""Recordings beside replays of the rig, before and after the causes are added: the numbers that the report draws."""
