"""A room that can be called: `gyrodrift.tune` is a package, and the function of that name for other programs.

Python binds a package's name to its parent as soon as anything in it is imported, so the function of the same name
cannot stand there beside it.
"""

import sys
from importlib import import_module
from types import ModuleType
from typing import Any


class CallableRoom(ModuleType):
    """A package whose call is that of the function of its name in `gyrodrift.library.analyses`."""

    def __call__(self, *arguments: Any, **options: Any) -> Any:
        """What the function gives."""
        name = self.__name__.rpartition(".")[2]
        return getattr(import_module("gyrodrift.library.analyses"), name)(*arguments, **options)


def make_callable(room: str) -> None:
    """Let a package be called."""
    sys.modules[room].__class__ = CallableRoom
