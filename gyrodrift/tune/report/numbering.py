"""The numbers of figures and tables in the report of a tuning: from 1, with those of the published method beside."""


def figure_name(number: int, published: int) -> str:
    """What a caption begins with, as HTML."""
    return _name("Figure", number, published)


def table_name(number: int, published: int | None = None) -> str:
    """Likewise; None for a table that the published method has not."""
    return _name("Table", number, published)


def _name(kind: str, number: int, published: int | None) -> str:
    beside = "" if published is None else f' <span class="note">(published: {kind} {published})</span>'
    return f"<b>{kind} {number}.</b>{beside}"
