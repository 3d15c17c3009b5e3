"""Finding the filter's parameters from recorded sessions."""

from gyrodrift.callable_room import make_callable

make_callable(__name__)
