"""A page for a person, whatever it tells of: one HTML file with its tables and figures."""
