"""Yaw errors of several drift filters on the same sessions: filters of this package and of other packages."""

from gyrodrift.io.callable_package import make_callable

make_callable(__name__)
