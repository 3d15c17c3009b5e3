"""Reports as one HTML file with tables and figures."""
