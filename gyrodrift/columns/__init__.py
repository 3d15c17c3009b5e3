"""Meaning of columns: names, units and the SPEC of `--columns`, for lines of a device and tables in files."""
