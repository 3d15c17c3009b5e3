"""Drift reducers side by side on the same sessions: this one, and those that people use instead."""

from gyrodrift.callable_package import make_callable

make_callable(__name__)
