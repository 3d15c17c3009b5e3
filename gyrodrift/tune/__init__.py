"""Find filter parameters from recorded sessions."""

from gyrodrift.callable_package import make_callable

make_callable(__name__)
