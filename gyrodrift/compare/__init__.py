"""Drift reducers side by side on the same sessions: this one, and those that people use instead."""
