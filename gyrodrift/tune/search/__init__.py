"""The search for the parameters that cost least."""
