"""A running service in the terminal."""
