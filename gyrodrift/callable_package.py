"""Packages that can be called: `gyrodrift.tune` is a package and a function of other programs.

Python binds the name of a package in its parent when anything in it is imported. A function of the same name cannot
stand there too.
"""

import sys
from importlib import import_module
from types import ModuleType
from typing import Any


class CallablePackage(ModuleType):
    """A package that calls the function of its name in `gyrodrift.library.analyses`."""

    def __call__(self, *arguments: Any, **options: Any) -> Any:
        """Call the function."""
        name = self.__name__.rpartition(".")[2]
        return getattr(import_module("gyrodrift.library.analyses"), name)(*arguments, **options)


def make_callable(package: str) -> None:
    """Let a package be called."""
    sys.modules[package].__class__ = CallablePackage
