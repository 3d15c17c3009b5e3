"""Recordings simulated again with their own motion, with and without each candidate."""
