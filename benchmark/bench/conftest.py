"""Fixtures of the tests, also for measurements."""

from conftest import log_as_it_is_at_first, nothing_left_behind, port, pytest_sessionstart, recordings

__all__ = ["log_as_it_is_at_first", "nothing_left_behind", "port", "pytest_sessionstart", "recordings"]
