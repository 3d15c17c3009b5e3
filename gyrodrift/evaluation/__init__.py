"""Yaw errors of sessions with a reference, for tune, compare and diagnose."""
