"""Reports as one HTML file: sections from templates, and charts as data."""
