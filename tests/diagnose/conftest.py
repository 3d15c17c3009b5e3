"""Fixtures of the tests of diagnoses."""

import pytest


@pytest.fixture(scope="session", autouse=True)
def compiled(diagnosis_kernels: None) -> None:
    """Wait for the process that compiles."""
