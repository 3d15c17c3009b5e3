"""Checks by subject; `registry` has all of them in the order of the report."""
