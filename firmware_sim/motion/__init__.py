"""Motion of the table: segments, and profiles of segments."""
