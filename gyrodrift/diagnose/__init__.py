"""Explain the gap between a simulated rig and real recordings."""

from gyrodrift.io.callable_package import make_callable

make_callable(__name__)
