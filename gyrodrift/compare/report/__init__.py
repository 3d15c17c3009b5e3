"""The files of a comparison: table, numbers, page."""
