"""Structlog without rich and Twisted.

Structlog imports both if they are installed, for tracebacks and for their event loops, and that takes longer than
structlog itself. Log lines here have no tracebacks. A program that imported structlog before is not affected.
"""

import sys
from collections.abc import Iterator
from contextlib import contextmanager

UNUSED = ("rich", "twisted")


@contextmanager
def _not_found(*packages: str) -> Iterator[None]:
    """Block the import of packages that are not loaded yet."""
    hidden = [name for name in packages if name not in sys.modules]
    sys.modules.update(dict.fromkeys(hidden))  # type: ignore[arg-type]  # None makes an import fail
    try:
        yield
    finally:
        for name in hidden:
            del sys.modules[name]


with _not_found(*UNUSED):
    import structlog
    from structlog.typing import FilteringBoundLogger

__all__ = ["FilteringBoundLogger", "structlog"]
