"""Callable packages: `gyrodrift.tune` is a package, and other programs call it as a function.

When a package is imported, Python sets its name in the parent package. So a function cannot have the same name there.
"""

import sys
from importlib import import_module
from types import ModuleType
from typing import Any


class CallablePackage(ModuleType):
    """A package; a call of it calls the function with its name in `gyrodrift.library.analyses`."""

    def __call__(self, *arguments: Any, **options: Any) -> Any:
        """Call the function."""
        name = self.__name__.rpartition(".")[2]
        return getattr(import_module("gyrodrift.library.analyses"), name)(*arguments, **options)


def make_callable(package: str) -> None:
    """Make an imported package callable."""
    sys.modules[package].__class__ = CallablePackage
