"""Simulators of others, for tests: models, flaws, cases and sessions."""
