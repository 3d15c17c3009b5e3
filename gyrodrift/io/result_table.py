"""Results as tables: for a notebook, for pandas and for Arrow."""

from abc import abstractmethod
from collections.abc import Mapping
from html import escape
from typing import Any

HTML_ROWS = 20
"""Most rows of a table in a notebook."""


class ResultTable:
    """A value with named columns of one length."""

    __slots__ = ()

    @abstractmethod
    def columns(self) -> Mapping[str, Any]:
        """Columns by name, all of one length."""

    def to_pandas(self) -> Any:
        """The columns as a `pandas.DataFrame`.

        Raises
        ------
        UsageError
            If pandas is not installed.
        """
        return _package("pandas", "to_pandas").DataFrame(dict(self.columns()))

    def to_arrow(self) -> Any:
        """The columns as a `pyarrow.Table`.

        Raises
        ------
        UsageError
            If pyarrow is not installed.
        """
        return _package("pyarrow", "to_arrow").table(dict(self.columns()))

    def _repr_html_(self) -> str:
        """A table for a notebook: the first rows."""
        columns = self.columns()
        count = max((len(column) for column in columns.values()), default=0)
        head = "".join(f"<th>{escape(name)}</th>" for name in columns)
        rows = "".join(
            f"<tr>{''.join(f'<td>{escape(_cell(column[row]))}</td>' for column in columns.values())}</tr>"
            for row in range(min(count, HTML_ROWS))
        )
        note = f"<p>{HTML_ROWS} of {count} rows</p>" if count > HTML_ROWS else ""
        caption = f"<caption>{escape(repr(self))}</caption>"
        return f"<table>{caption}<thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>{note}"


def _cell(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _package(name: str, method: str) -> Any:
    from importlib import import_module  # noqa: PLC0415 - an optional package

    from gyrodrift.io.installation import package_command  # noqa: PLC0415
    from gyrodrift.values.errors import UsageError  # noqa: PLC0415

    try:
        return import_module(name)
    except ImportError as error:
        raise UsageError(f"{method} needs the package {name}: {package_command(name)}") from error
