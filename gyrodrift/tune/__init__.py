"""Find filter parameters from recorded sessions."""

from gyrodrift.io.callable_package import make_callable

make_callable(__name__)
