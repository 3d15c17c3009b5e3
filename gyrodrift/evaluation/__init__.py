"""Shared by tune, compare and diagnose: sessions with a reference, and yaw errors against it."""
