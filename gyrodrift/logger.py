"""Structlog, without what it would load only because it is installed.

Structlog imports rich and Twisted wherever it finds them, to draw tracebacks and to log from their loops, and loading
them takes longer than structlog itself. No log line of ours has a traceback, so that here it finds neither. A program
that has imported structlog itself keeps what that gave it.
"""

import sys
from collections.abc import Iterator
from contextlib import contextmanager

UNUSED = ("rich", "twisted")


@contextmanager
def _not_found(*packages: str) -> Iterator[None]:
    """Within it, packages that are not loaded yet cannot be."""
    hidden = [name for name in packages if name not in sys.modules]
    sys.modules.update(dict.fromkeys(hidden))  # type: ignore[arg-type]  # None is what makes an import fail
    try:
        yield
    finally:
        for name in hidden:
            del sys.modules[name]


with _not_found(*UNUSED):
    import structlog
    from structlog.typing import FilteringBoundLogger

__all__ = ["FilteringBoundLogger", "structlog"]
