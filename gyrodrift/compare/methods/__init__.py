"""The compared methods, one small file for each."""
