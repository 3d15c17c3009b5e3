"""Safe display of foreign names: in `status`, in the log, on the page, in metrics."""

LONGEST_NAME = 40


def shown_name(name: str | bytes) -> str:
    """A name with escapes for unprintable characters, shortened if it is long."""
    text = name if isinstance(name, str) else name.decode("utf-8", "backslashreplace")
    cut = text[:LONGEST_NAME] + "…" * (len(text) > LONGEST_NAME)
    return "".join(character if character.isprintable() else repr(character)[1:-1] for character in cut)


def well_formed(name: str) -> str:
    """A name as valid UTF-8, with escapes for other bytes."""
    return name.encode("utf-8", "backslashreplace").decode()
