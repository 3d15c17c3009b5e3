"""Numbers of figures and tables in the report of a tuning, with the numbers of the publication."""


def figure_name(number: int, published: int) -> str:
    """Beginning of a figure caption, as HTML."""
    return _name("Figure", number, published)


def table_name(number: int, published: int | None = None) -> str:
    """Beginning of a table caption, as HTML; `published` is None for a table that is not in the publication."""
    return _name("Table", number, published)


def _name(kind: str, number: int, published: int | None) -> str:
    note = "" if published is None else f' <span class="note">(published: {kind} {published})</span>'
    return f"<b>{kind} {number}.</b>{note}"
