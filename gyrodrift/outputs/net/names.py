"""Names from outside as they may be shown: in `status`, in the log, on the page, in metrics."""

LONGEST_NAME = 40


def shown_name(name: str | bytes) -> str:
    """A name of printable characters; others become escapes, and a long name is cut."""
    text = name if isinstance(name, str) else name.decode("utf-8", "backslashreplace")
    cut = text[:LONGEST_NAME] + "…" * (len(text) > LONGEST_NAME)
    return "".join(each if each.isprintable() else repr(each)[1:-1] for each in cut)


def well_formed(name: str) -> str:
    """A name that UTF-8 can hold: bytes of a path that are no text become escapes."""
    return name.encode("utf-8", "backslashreplace").decode()
